"""Snapshots: take one, list those of a session, fetch one."""

from typing import Annotated

from fastapi import Depends, Query
from fastapi.responses import Response

from robot_runtime.contract.topics import SNAPSHOT
from server.features.snapshots.schemas import TakenSnapshot
from server.features.snapshots.taker import SnapshotLostError, SnapshotRefusedError, SnapshotTaker
from server.http.dependencies import Provided
from server.http.heavy_requests import RecordingTurn, TooManyHeavyError
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.library.content import Recording, reading_content
from server.library.snapshots import SnapshotValues, list_snapshots
from server.platform.errors import NotFoundError
from server.platform.store import Store
from server.recording.session import UnknownSessionError, find_row
from server.stream.bridge import RuntimeSilentError

SECONDS_MAX = 1e9

router = Operations(prefix="/api", tags=["sessions"])


def _open(store: Provided[Store], session: Identifier) -> Recording:
    return Recording(store, find_row(store, session))


OpenRecording = Annotated[Recording, Depends(_open)]
Seconds = Annotated[
    float, Query(ge=-SECONDS_MAX, le=SECONDS_MAX, allow_inf_nan=False, description="s since the start")
]


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
    _: RecordingTurn, recording: OpenRecording, after: Seconds = -SECONDS_MAX
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
def get_snapshot(_: RecordingTurn, recording: OpenRecording, time: Seconds) -> Response:
    """Return the first snapshot from this time on, as it was taken."""
    for _moment, jpeg in recording.pictures(SNAPSHOT.name, recording.row.started_steady + time):
        return Response(jpeg, media_type="image/jpeg", headers={"cache-control": "private, no-cache"})
    raise NotFoundError(f"Session {recording.row.id} has no snapshot from {time:g} s on.")
