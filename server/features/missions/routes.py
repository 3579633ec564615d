"""Missions: library, check, trial, start."""

from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from pydantic import TypeAdapter

from robot_runtime.contract.commands import MissionCommand
from robot_runtime.contract.documents import Mission
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.errors import RefusedError
from robot_runtime.missions.checks import check_sights, list_sights
from robot_runtime.missions.document import MissionDocument
from server.features.lease.admission import admit, require_control
from server.features.missions.library import MissionLibrary, UnknownMissionError, read_table
from server.features.missions.nodes import list_node_kinds
from server.features.missions.schemas import (
    MissionBody,
    MissionCheck,
    MissionNodeKind,
    MissionSummary,
    MissionText,
    MissionTrial,
    MissionVersion,
    NewMission,
    TrialStart,
    summarize_mission,
)
from server.features.missions.trials import MissionTrials
from server.features.parameters.changes import COMMAND_ERRORS, Changes
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.heavy_requests import TooManyHeavyError, Turn
from server.http.operations import MeantRun, Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.disk_space import FileWriteError, check_room
from server.platform.errors import UnavailableError
from server.platform.settings import Settings
from server.stream.bridge import Bridge, RuntimeSilentError

REFUSED = {409: "Refused now", 422: "The mission cannot be used"}

router = Operations(prefix="/api/missions", tags=["missions"])


def _library(settings: Settings) -> MissionLibrary:
    return MissionLibrary(settings.data.missions, settings.missions)


@router.operation("GET", Need.VIEWER)
def list_missions(settings: Provided[Settings]) -> list[MissionText]:
    """List the missions: those of the program, then those of the data folder in their newest version."""
    return _library(settings).describe()


@router.operation("POST", Need.OPERATOR, REFUSED, FileWriteError, status_code=201)
async def keep_mission(settings: Provided[Settings], caller: Caller, body: NewMission) -> MissionSummary:
    """Store a mission in the data folder under its own name, as a new version."""
    keep = _library(settings).keep
    return summarize_mission(await run_in_threadpool(keep, body.text, caller.name, body.base))


@router.operation(
    "DELETE /{name}", Need.OPERATOR, UnknownMissionError, {409: "It is shipped"}, status_code=204
)
def delete_mission(settings: Provided[Settings], name: str) -> None:
    """Delete a mission of the data folder with all its versions."""
    _library(settings).delete(name)


@router.operation("GET /versions/{name}", Need.VIEWER, UnknownMissionError)
def list_mission_versions(settings: Provided[Settings], name: str) -> list[MissionVersion]:
    """List the versions of a mission of the data folder, the newest first."""
    return _library(settings).versions(name)


@router.operation("GET /nodes", Need.VIEWER)
def list_mission_nodes() -> list[MissionNodeKind]:
    """List the leaves and branches that a mission may have, with their fields and limits."""
    return list_node_kinds()


@router.operation("POST /check", Need.VIEWER, TooManyHeavyError)
async def check_mission(
    _: Turn, settings: Provided[Settings], bridge: Provided[Bridge], body: MissionBody
) -> MissionCheck:
    """Check a mission: its problems by entry, or its summary and what the robot cannot see."""
    table = await run_in_threadpool(read_table, body.text)
    try:
        mission = await run_in_threadpool(_library(settings).read, body.text)
    except ConfigError as problem:
        return MissionCheck(problems=list(problem.problems), summary=None, unseen=[], table=table)
    unseen = await _find_unseen(mission, bridge)
    return MissionCheck(problems=[], summary=summarize_mission(mission), unseen=unseen, table=table)


async def _find_unseen(mission: MissionDocument, bridge: Bridge) -> list[str]:
    if not list_sights(mission):
        return []
    try:
        answer = await bridge.query("vision")
    except (RefusedError, RuntimeSilentError):
        return []
    return check_sights(mission, parse(VisionSettings, answer["settings"]))


@router.operation("POST /start", Need.CONTROL, REFUSED, *COMMAND_ERRORS, status_code=201)
async def start_mission(
    request: Request,
    settings: Provided[Settings],
    changes: Provided[Changes],
    caller: Caller,
    body: MissionBody,
) -> MissionSummary:
    """Arm the robot and begin a mission, or refuse with every reason against either."""
    library = _library(settings)
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

    503 where one was running, and the runtime says nothing now.
    """
    await monitor.catch_up("mission", bridge.answered)
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
    library = _library(settings)
    mission = await run_in_threadpool(library.read, body.text)
    called = await run_in_threadpool(library.called_by, body.text)
    await admit(request)
    trials.start(mission.name, body.text, called, body.seeds)
    return trials.state()


@router.operation("POST /trial/cancel", Need.OPERATOR, {409: "None runs, or the one that is meant is over"})
async def cancel_mission_trial(trials: Provided[MissionTrials], run: MeantRun = None) -> None:
    """Cancel the running trial; its results stay."""
    trials.cancel(run)
