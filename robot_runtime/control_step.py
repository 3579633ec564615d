"""The round of a robot that hears its board in step with control: receive, control, publish."""

from collections.abc import Callable

from robot_runtime.contract.packets import Depth
from robot_runtime.control.fault_detector import IN_STEP_EARLY
from robot_runtime.core import Core
from robot_runtime.link.phase_lock import PhaseLock
from robot_runtime.link.timing import periods


class ControlStep:
    """The rounds of this robot. `run` belongs to one thread.

    `receive` handles what the board sends within so many s; it returns False where it cannot now.
    """

    def __init__(self, robot: Core, receive: Callable[[float], bool]) -> None:
        self._robot = robot
        self._receive = receive
        self._arrived: float | None = None
        period, baud = 1 / robot.config.control.rate, robot.config.link.baud
        self._phase = PhaseLock(robot.clock.now() + period, period, periods(baud)[Depth])
        robot.supervisor.detector.early = IN_STEP_EARLY

    @property
    def due(self) -> float:
        """The time of the next round, s."""
        return self._phase.due

    def run(self) -> None:
        """Run the round that is due."""
        self._arrived = None
        self._robot.step(self._take_newest)
        self._phase.advance(self._robot.clock.now(), self._arrived)

    def _take_newest(self) -> None:
        """Take what has come, and where the phase asks for it wait for the depth of this round."""
        if not self._receive(0.0) or not self._phase.waits:
            return
        clock, control = self._robot.clock, self._robot.control
        end, before = clock.now() + self._phase.patience, control.newest_depth
        while (wait := end - clock.now()) > 0 and self._receive(wait):
            if control.newest_depth != before:
                self._arrived = clock.now()
                return
