"""Scenarios: those there are, checking, running, cancelling."""

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool

from robot_runtime.experiments.scenario.document import ScenarioError, read_scenario
from server.features.lease.admission import require_control
from server.features.scenarios.library import keep_scenario, list_scenarios
from server.features.scenarios.runs import ScenarioRunner as ScenarioRuns
from server.features.scenarios.schemas import (
    ScenarioCheck,
    ScenarioDocument,
    ScenarioStart,
    ScenarioStarted,
    ScenarioState,
    ScenarioSummary,
    ScenarioText,
    summarize,
)
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, needs
from server.platform.settings import Settings

REFUSED = answers(_409="Refused now", _422="The scenario cannot be run")
START = {**REFUSED, **answers(_423="On the robot: control is with somebody else")}

router = APIRouter(prefix="/api/scenarios", tags=["scenarios"])


@router.get(
    "", summary="The scenarios that there are", operation_id="listScenarios", openapi_extra=needs(Need.VIEWER)
)
def get_scenarios(settings: Provided[Settings]) -> list[ScenarioText]:
    """Those that come with the program, the thesis's own first, then those in the data folder."""
    return list_scenarios(settings.data.scenarios)


@router.post(
    "",
    status_code=201,
    summary="Keep a scenario",
    operation_id="keepScenario",
    openapi_extra=needs(Need.OPERATOR),
    responses=REFUSED,
)
async def keep(settings: Provided[Settings], document: ScenarioDocument) -> ScenarioSummary:
    """Write it into the data folder under its own name, over one of that name."""
    folder = settings.data.scenarios
    return summarize(await run_in_threadpool(keep_scenario, folder, document.text))


@router.post(
    "/check",
    summary="What is wrong with a scenario",
    operation_id="checkScenario",
    openapi_extra=needs(Need.VIEWER),
)
def check(document: ScenarioDocument) -> ScenarioCheck:
    """Its problems, field by field; or what it says."""
    try:
        return ScenarioCheck(problems=[], summary=summarize(read_scenario(document.text)))
    except ScenarioError as problem:
        return ScenarioCheck(problems=list(problem.problems), summary=None)


@router.get("/state", summary="What runs", operation_id="getScenarioState", openapi_extra=needs(Need.VIEWER))
async def get_state(scenarios: Provided[ScenarioRuns]) -> ScenarioState:
    """The active run, the queue and the last run, as on the live socket."""
    return scenarios.state()


@router.post(
    "/runs",
    status_code=201,
    summary="Run a scenario",
    operation_id="startScenario",
    openapi_extra=needs(Need.OPERATOR),
    responses=START,
)
async def start(
    request: Request, scenarios: Provided[ScenarioRuns], caller: Caller, body: ScenarioStart
) -> ScenarioStarted:
    """Live: at once, or refused with the reasons. In simulated time: at once, or in its turn."""
    if body.place == "live":
        require_control(request)
    run = scenarios.start(body.text, body.place, body.board, caller.name)
    return ScenarioStarted(run=run)


@router.post(
    "/cancel",
    status_code=204,
    summary="Cancel what runs",
    operation_id="cancelScenario",
    openapi_extra=needs(Need.OPERATOR),
)
async def cancel(scenarios: Provided[ScenarioRuns]) -> None:
    """End the active run and clear the queue; recordings stay. The end is reported on the live socket."""
    scenarios.cancel()
