"""The plug of the bring-up."""

from typing import ClassVar

from server.board_reservation import BoardReservation, RobotBoard
from server.feature import Plug
from server.features.bring_up.bring_up_run import BringUpRun
from server.platform.settings import Settings
from server.processes.supervisor import ProcessSupervisor
from server.services import Maker
from server.stream.bridge import Bridge


def make_bring_up(
    settings: Settings, board: RobotBoard, reservation: BoardReservation, processes: ProcessSupervisor
) -> BringUpRun:
    """Return the bring-up of this robot."""
    return BringUpRun(settings, board, reservation.reserve, processes)


class BringUpPlug(Plug):
    """The plug that ends a bring-up at a STOP."""

    makers: ClassVar[tuple[Maker, ...]] = (make_bring_up,)

    def __init__(self, bring_up: BringUpRun, bridge: Bridge) -> None:
        self._bring_up = bring_up
        bridge.on_stop.append(bring_up.see_stop)

    async def stop(self) -> None:
        """End the bring-up."""
        await self._bring_up.close()
