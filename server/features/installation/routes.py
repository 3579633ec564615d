"""Updates of the software on the robot's computer."""

from fastapi import Request

from server.driving.admission import read_admitted
from server.features.installation.page_updates import PageUpdates
from server.features.installation.schemas import UpdateState
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.http.uploads import InvalidUploadError
from server.platform.disk_space import FileWriteError
from server.recording.recorder import Recorder

router = Operations(prefix="/api/update", tags=["update"])

REFUSED = {409: "Refused now"}


@router.operation("GET", Need.VIEWER)
def get_update(updates: Provided[PageUpdates]) -> UpdateState:
    """Return the versions on the robot's computer, and the present or last update."""
    return updates.state()


@router.operation(
    "POST /release",
    Need.OPERATOR,
    InvalidUploadError,
    FileWriteError,
    REFUSED,
    openapi_extra={
        "requestBody": {"required": True, "content": {"application/zip": {"schema": {"type": "string"}}}}
    },
)
async def send_release(
    request: Request, monitor: Provided[HealthMonitor], updates: Provided[PageUpdates]
) -> UpdateState:
    """Send the ZIP file of a release, the request's body. It changes nothing until the update is begun."""
    monitor.require_disarmed("An upload slows the recording.")
    length = request.headers.get("content-length")
    await updates.receive(read_admitted(request), int(length) if length else None)
    return updates.state()


@router.operation("POST", Need.ADMINISTER, FileWriteError, REFUSED)
async def begin_update(
    monitor: Provided[HealthMonitor], recorder: Provided[Recorder], updates: Provided[PageUpdates]
) -> UpdateState:
    """Update to the received release.

    It is refused if it is not signed with the key that the installation knows. A version that is not healthy
    within a minute is taken back. The server is away for half a minute.
    """
    monitor.require_disarmed("The robot's software is replaced.")
    await updates.begin(recording=recorder.session is not None)
    return updates.state()
