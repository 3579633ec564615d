"""The plug of the board: its reservation, and uploads of firmware."""

from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from server.board_reservation import BoardReservation, RobotBoard
from server.feature import Plug
from server.features.board.firmware_upload import FirmwareUpload
from server.health.monitor import HealthMonitor
from server.health.occupation import Occupation
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.processes.supervisor import ProcessSupervisor
from server.recording.provenance import ProvenanceWatch
from server.services import Maker
from server.stream.bridge import Bridge


def make_board(settings: Settings, notices: Notices, provenance: ProvenanceWatch) -> RobotBoard:
    """Return the robot's board."""
    return RobotBoard(settings, notices.notify, provenance.read_firmware)


def make_reservation(
    board: RobotBoard,
    bridge: Bridge,
    monitor: HealthMonitor,
    processes: ProcessSupervisor,
    clock: Clock,
    occupation: Occupation,
) -> BoardReservation:
    """Return the reservation of the board."""
    return BoardReservation(board, bridge, monitor, processes, clock, occupation.of_board)


def make_upload(settings: Settings, board: RobotBoard, reservation: BoardReservation) -> FirmwareUpload:
    """Return the upload of firmware."""
    return FirmwareUpload(settings, board, reservation.reserve)


class BoardPlug(Plug):
    """The plug that starts the robot's processes, once its firmware is on the board."""

    makers: ClassVar[tuple[Maker, ...]] = (make_board, make_reservation, make_upload)

    def __init__(self, reservation: BoardReservation, upload: FirmwareUpload) -> None:
        self._reservation = reservation
        self._upload = upload

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Restore the robot's firmware if the board holds another, and start the processes."""
        return (self._reservation.start_processes(),)

    async def stop(self) -> None:
        """Wait for an upload."""
        await self._upload.close()
