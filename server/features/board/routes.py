"""Uploads of firmware to the robot's board."""

from server.features.board.firmware_upload import FirmwareUpload
from server.features.board.schemas import UploadOrder, UploadState
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api/firmware", tags=["board"])

REFUSED = {409: "Refused now"}


@router.operation("GET", Need.VIEWER)
def get_firmware_upload(upload: Provided[FirmwareUpload]) -> UploadState:
    """Return the present or last upload of firmware, and the previous firmware."""
    return upload.state()


@router.operation("POST", Need.ADMINISTER, REFUSED)
async def upload_firmware(
    monitor: Provided[HealthMonitor], upload: Provided[FirmwareUpload], order: UploadOrder
) -> UploadState:
    """Upload firmware to the robot's board, and verify it; its previous firmware is stored before."""
    monitor.require_disarmed("The robot's firmware is replaced.")
    await upload.begin(order.firmware)
    return upload.state()
