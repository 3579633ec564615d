"""Start and stop of recordings."""

import json

from fastapi.concurrency import run_in_threadpool

from robot_runtime.clock import Clock
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.library.catalogue import Catalogue
from server.library.schemas import NewSession
from server.platform.errors import ConflictError
from server.platform.settings import Settings
from server.recording.recorder import Recorder, RecordingRefusedError
from server.recording.schemas import Session
from server.recording.session import UnknownSessionError, new_row
from server.stream.bridge import Bridge

router = Operations(prefix="/api", tags=["sessions"])


@router.operation("POST /sessions", Need.OPERATOR, ConflictError, status_code=201)
async def start_session(
    bridge: Provided[Bridge],
    monitor: Provided[HealthMonitor],
    settings: Provided[Settings],
    clock: Provided[Clock],
    recorder: Provided[Recorder],
    body: NewSession,
) -> Session:
    """Start recording everything; refused while another session records or a test uses the board."""
    if bridge.reserved_reason is not None:
        raise RecordingRefusedError(bridge.reserved_reason)
    state = json.dumps(monitor.state())
    row = await run_in_threadpool(new_row, settings, clock, body.name, body.note, state)
    return await recorder.start(row)


@router.operation("POST /sessions/{session}/stop", Need.OPERATOR, UnknownSessionError, ConflictError)
async def stop_session(
    catalogue: Provided[Catalogue], recorder: Provided[Recorder], session: Identifier
) -> Session:
    """Stop recording; the answer comes when all earlier samples are stored."""
    await run_in_threadpool(catalogue.find, session)
    return await recorder.stop(session)
