"""Reports the craft that the simulator swims, so that recordings have it."""

from robot_runtime.contract.craft import CraftDocument
from robot_runtime.contract.documents import SwimmingCraft
from robot_runtime.simulation.water.simulator import Simulator

PERIOD = 10.0
"""s."""


class CraftReport:
    """The reports of a simulator whose craft comes from this file."""

    def __init__(self, simulator: Simulator, file: CraftDocument) -> None:
        self._simulator = simulator
        self._file = file
        self._last: SwimmingCraft | None = None

    def due(self, now: float) -> SwimmingCraft | None:
        """Return the document at its first call, after a change and every `PERIOD`; `now` is its time, s.

        Also where the time has run back, as after a reboot of the robot whose clock it is.
        """
        file, craft, last = self._file, self._simulator.craft(), self._last
        if last is not None and craft == last.craft and last.time <= now < last.time + PERIOD:
            return None
        title = file.title if craft == file.craft else f"{file.title}, changed"
        made = SwimmingCraft(time=now, title=title, origin=file.origin, craft=craft)
        self._last = made
        return made
