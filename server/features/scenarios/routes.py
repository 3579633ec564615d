"""Scenarios: list, check, run, cancel."""

from fastapi import Request
from fastapi.concurrency import run_in_threadpool

from robot_runtime.contract.limits import ConfigError
from robot_runtime.experiments.scenario.document import read_scenario
from server.driving.admission import admit, require_control
from server.features.scenarios import library
from server.features.scenarios.event_kinds import list_event_kinds
from server.features.scenarios.runs import ScenarioRunner
from server.features.scenarios.schemas import (
    NewScenario,
    ScenarioCheck,
    ScenarioDocument,
    ScenarioEventKind,
    ScenarioStart,
    ScenarioStarted,
    ScenarioState,
    ScenarioSummary,
    ScenarioText,
    summarize,
)
from server.http.dependencies import Provided
from server.http.heavy_requests import TooManyHeavyError, Turn
from server.http.operations import MeantRun, Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.disk_space import FileWriteError
from server.platform.runs import RunOverError
from server.platform.settings import Settings

REFUSED = {409: "Refused now", 422: "The scenario cannot be run"}

router = Operations(prefix="/api/scenarios", tags=["scenarios"])


@router.operation("GET", Need.VIEWER)
def list_scenarios(settings: Provided[Settings]) -> list[ScenarioText]:
    """List the scenarios: those of the program, the thesis's own first, then those of the data folder."""
    return library.list_scenarios(settings.data.scenarios)


@router.operation("POST", Need.OPERATOR, REFUSED, FileWriteError, status_code=201)
async def keep_scenario(settings: Provided[Settings], document: NewScenario) -> ScenarioSummary:
    """Store a scenario in the data folder under its own name, replacing one of that name."""
    folder = settings.data.scenarios
    return summarize(await run_in_threadpool(library.keep_scenario, folder, document.text, document.base))


@router.operation("POST /check", Need.VIEWER, TooManyHeavyError)
def check_scenario(_: Turn, document: ScenarioDocument) -> ScenarioCheck:
    """Check a scenario: its problems field by field, or its summary."""
    try:
        return ScenarioCheck(problems=[], summary=summarize(read_scenario(document.text)))
    except ConfigError as problem:
        return ScenarioCheck(problems=list(problem.problems), summary=None)


@router.operation("GET /events", Need.VIEWER)
def list_scenario_events() -> list[ScenarioEventKind]:
    """List the kinds of events that a scenario may have, with their fields and limits."""
    return list_event_kinds()


@router.operation("GET /state", Need.VIEWER)
async def get_scenario_state(scenarios: Provided[ScenarioRunner]) -> ScenarioState:
    """Return the active run, the queue and the last run, as on the live socket."""
    return scenarios.state()


@router.operation(
    "POST /runs",
    Need.OPERATOR,
    REFUSED,
    {423: "On the robot: control is with somebody else"},
    status_code=201,
)
async def start_scenario(
    request: Request,
    settings: Provided[Settings],
    scenarios: Provided[ScenarioRunner],
    caller: Caller,
    body: ScenarioStart,
) -> ScenarioStarted:
    """Run a scenario: live at once, or refused with the reasons; in simulated time after queued ones."""
    if body.place == "live":
        require_control(request)
    scenario = await run_in_threadpool(lambda: read_scenario(body.text, settings.read_craft()))
    # Access may have been revoked, and control changed hands, in the meantime.
    await admit(request)
    if body.place == "live":
        require_control(request)
    run = scenarios.start(scenario, body.text, body.place, body.board, caller.name)
    return ScenarioStarted(run=run)


@router.operation("POST /cancel", Need.OPERATOR, RunOverError)
async def cancel_scenario(scenarios: Provided[ScenarioRunner], run: MeantRun = None) -> None:
    """Cancel this run; without one cancel the active run and clear the queue. Recordings stay."""
    scenarios.cancel(run)
