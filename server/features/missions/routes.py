"""The library of missions, and the check of one."""

from fastapi.concurrency import run_in_threadpool

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.errors import RefusedError
from robot_runtime.missions.checks import check_sights, list_sights
from robot_runtime.missions.document import MissionDocument
from server.features.missions.library import UnknownMissionError, open_library, read_table
from server.features.missions.nodes import list_node_kinds
from server.features.missions.past_runs import PastMissionRuns
from server.features.missions.schemas import (
    MissionBody,
    MissionCheck,
    MissionNodeKind,
    MissionSummary,
    MissionText,
    MissionVersion,
    NewMission,
    PastMissionRun,
    describe_plan,
    summarize_mission,
)
from server.http.dependencies import Provided
from server.http.heavy_requests import ReadingTurn, TooManyHeavyError, Turn
from server.http.operations import Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.disk_space import FileWriteError
from server.platform.settings import Settings
from server.stream.bridge import Bridge, RuntimeSilentError

REFUSED = {409: "Refused now", 422: "The mission cannot be used"}

router = Operations(prefix="/api/missions", tags=["missions"])


@router.operation("GET", Need.VIEWER)
def list_missions(settings: Provided[Settings]) -> list[MissionText]:
    """List the missions: those of the program, then those of the data folder in their newest version."""
    return open_library(settings).describe()


@router.operation("POST", Need.OPERATOR, REFUSED, FileWriteError, status_code=201)
async def keep_mission(settings: Provided[Settings], caller: Caller, body: NewMission) -> MissionSummary:
    """Store a mission in the data folder under its own name, as a new version."""
    keep = open_library(settings).keep
    return summarize_mission(await run_in_threadpool(keep, body.text, caller.name, body.base))


@router.operation(
    "DELETE /{name}", Need.OPERATOR, UnknownMissionError, {409: "It is shipped"}, status_code=204
)
def delete_mission(settings: Provided[Settings], name: str) -> None:
    """Delete a mission of the data folder with all its versions."""
    open_library(settings).delete(name)


@router.operation("GET /versions/{name}", Need.VIEWER, UnknownMissionError)
def list_mission_versions(settings: Provided[Settings], name: str) -> list[MissionVersion]:
    """List the versions of a mission of the data folder, the newest first."""
    return open_library(settings).versions(name)


@router.operation("GET /runs/{name}", Need.VIEWER, TooManyHeavyError)
def list_mission_runs(_: ReadingTurn, runs: Provided[PastMissionRuns], name: str) -> list[PastMissionRun]:
    """List the last runs of a mission that sessions recorded, the newest first; twelve at most."""
    return runs.find(name)


@router.operation("GET /nodes", Need.VIEWER)
def list_mission_nodes() -> list[MissionNodeKind]:
    """List the leaves and branches that a mission may have, with their fields and limits."""
    return list_node_kinds()


@router.operation("POST /check", Need.VIEWER, TooManyHeavyError)
async def check_mission(
    _: Turn, settings: Provided[Settings], bridge: Provided[Bridge], body: MissionBody
) -> MissionCheck:
    """Check a mission: its problems by entry, or its summary with sights that the robot cannot detect."""
    table = await run_in_threadpool(read_table, body.text)
    try:
        mission = await run_in_threadpool(open_library(settings).read, body.text)
    except ConfigError as problem:
        return MissionCheck(problems=list(problem.problems), summary=None, plan=None, unseen=[], table=table)
    unseen = await _find_unseen(mission, bridge)
    return MissionCheck(
        problems=[],
        summary=summarize_mission(mission),
        plan=describe_plan(mission),
        unseen=unseen,
        table=table,
    )


async def _find_unseen(mission: MissionDocument, bridge: Bridge) -> list[str]:
    if not list_sights(mission):
        return []
    try:
        answer = await bridge.query("vision")
    except (RefusedError, RuntimeSilentError):
        return []
    return check_sights(mission, parse(VisionSettings, answer["settings"]))
