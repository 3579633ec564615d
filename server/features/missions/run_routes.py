"""Missions that run: on the robot, and as trials in simulated water."""

from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from pydantic import TypeAdapter

from robot_runtime.contract.commands import MissionCommand
from robot_runtime.contract.documents import Mission
from robot_runtime.contract.topics import MISSION
from server.driving.admission import admit, require_control
from server.driving.changes import COMMAND_ERRORS, Changes
from server.features.missions.library import open_library
from server.features.missions.routes import REFUSED
from server.features.missions.schemas import (
    MissionBody,
    MissionSummary,
    MissionTrial,
    TrialStart,
    summarize_mission,
)
from server.features.missions.trials import MissionTrials
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import MeantRun, Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.disk_space import check_room
from server.platform.errors import UnavailableError
from server.platform.settings import Settings
from server.stream.bridge import Bridge

router = Operations(prefix="/api/missions", tags=["missions"])


@router.operation("POST /start", Need.CONTROL, REFUSED, *COMMAND_ERRORS, status_code=201)
async def start_mission(
    request: Request,
    settings: Provided[Settings],
    changes: Provided[Changes],
    caller: Caller,
    body: MissionBody,
) -> MissionSummary:
    """Arm the robot and begin a mission, or refuse with all reasons against either."""
    library = open_library(settings)
    mission = await run_in_threadpool(library.read, body.text)
    called = await run_in_threadpool(library.called_by, body.text)
    # Access may have been revoked, and control changed hands, in the meantime.
    await admit(request)
    require_control(request)
    check_room(settings.data)
    await changes.command(caller.name, MissionCommand(text=body.text, library=called))
    return summarize_mission(mission)


@router.operation("GET /state", Need.VIEWER, UnavailableError)
async def get_mission_state(monitor: Provided[HealthMonitor], bridge: Provided[Bridge]) -> Mission | None:
    """Return the running mission, or the last one, as on the live socket; null where there was none.

    503 where one was running, and the runtime is silent now.
    """
    await monitor.catch_up(MISSION, bridge.answered)
    state = monitor.mission()
    if state is not None and state["phase"] in ("running", "paused"):
        monitor.require_heard()
    return None if state is None else TypeAdapter(Mission).validate_python(state)


@router.operation("GET /trial", Need.VIEWER)
async def get_mission_trial(trials: Provided[MissionTrials]) -> MissionTrial:
    """Return the running trial, or the last one, with its results so far."""
    return trials.state()


@router.operation("POST /trial", Need.OPERATOR, REFUSED, status_code=201)
async def start_mission_trial(
    request: Request, settings: Provided[Settings], trials: Provided[MissionTrials], body: TrialStart
) -> MissionTrial:
    """Try a mission in simulated water, once for each seed."""
    library = open_library(settings)
    mission = await run_in_threadpool(library.read, body.text)
    called = await run_in_threadpool(library.called_by, body.text)
    await admit(request)
    trials.start(mission.name, body.text, called, body.seeds)
    return trials.state()


@router.operation("POST /trial/cancel", Need.OPERATOR, {409: "None runs, or the one that is meant is over"})
async def cancel_mission_trial(trials: Provided[MissionTrials], run: MeantRun = None) -> None:
    """Cancel the running trial; its results stay."""
    trials.cancel(run)
