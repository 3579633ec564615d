"""Snapshots: take one, list those of a session, fetch one."""

from fastapi.responses import Response

from robot_runtime.contract.topics import SNAPSHOT
from server.features.snapshots.schemas import TakenSnapshot
from server.features.snapshots.taker import SnapshotLostError, SnapshotRefusedError, SnapshotTaker
from server.http.dependencies import Provided
from server.http.heavy_requests import RecordingTurn, TooManyHeavyError
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.library.content import reading_content
from server.library.opening import SECONDS_MAX, Moment, OpenRecording
from server.library.snapshots import SnapshotValues, list_snapshots
from server.platform.errors import NotFoundError
from server.recording.session import UnknownSessionError
from server.stream.bridge import RuntimeSilentError

router = Operations(prefix="/api", tags=["sessions"])


@router.operation(
    "POST /snapshots",
    Need.OPERATOR,
    SnapshotRefusedError,
    SnapshotLostError,
    RuntimeSilentError,
    status_code=201,
)
async def take_snapshot(taker: Provided[SnapshotTaker]) -> TakenSnapshot:
    """Take a snapshot: the camera's newest picture at full size, into the session that records.

    The answer comes when it is stored. Refused while nothing is recorded.
    """
    return await taker.take()


@router.operation("GET /sessions/{session}/snapshots", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def list_session_snapshots(
    _: RecordingTurn, recording: OpenRecording, after: Moment = -SECONDS_MAX
) -> list[SnapshotValues]:
    """List the snapshots of a session after a time, the first sixty, with depth, attitude and position then.

    `after` of the last one gives the next sixty.
    """
    with reading_content(recording.row):
        return list_snapshots(recording, recording.row.started_steady + after)


@router.operation(
    "GET /sessions/{session}/snapshot",
    Need.VIEWER,
    UnknownSessionError,
    TooManyHeavyError,
    media_type="image/jpeg",
    linked=True,
)
def get_snapshot(_: RecordingTurn, recording: OpenRecording, time: Moment) -> Response:
    """Return the first snapshot from this time on, as it was taken."""
    for _moment, jpeg in recording.pictures(SNAPSHOT.name, recording.row.started_steady + time):
        return Response(jpeg, media_type="image/jpeg", headers={"cache-control": "private, no-cache"})
    raise NotFoundError(f"Session {recording.row.id} has no snapshot from {time:g} s on.")
