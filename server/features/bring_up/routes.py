"""The bring-up: begin, act, state, end, report."""

from fastapi.responses import HTMLResponse

from server.features.bring_up.bring_up_run import BringUpRun, NoReportError
from server.features.bring_up.schemas import BringUpOrder, BringUpState, HandsOrder
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import MeantRun, Operations
from server.http.sign_in.policy import Need
from server.platform.runs import RunOverError

router = Operations(prefix="/api/bring-up", tags=["board"])

REFUSED = {409: "Refused now"}


@router.operation("GET", Need.VIEWER)
def get_bring_up(bring_up: Provided[BringUpRun]) -> BringUpState:
    """Return the bring-up's steps with their results, and the newest readings."""
    return bring_up.state()


@router.operation("POST", Need.CONTROL, REFUSED)
async def begin_bring_up(monitor: Provided[HealthMonitor], bring_up: Provided[BringUpRun]) -> BringUpState:
    """Begin a bring-up: its sketch is uploaded to the robot's board, which takes some seconds."""
    monitor.require_disarmed("A bring-up uploads another program to the board.")
    await bring_up.begin()
    return bring_up.state()


@router.operation("DELETE", Need.OPERATOR, RunOverError)
def end_bring_up(bring_up: Provided[BringUpRun], run: MeantRun = None) -> BringUpState:
    """End the bring-up: the report is written, and the robot's firmware uploaded again."""
    bring_up.end(run)
    return bring_up.state()


@router.operation("POST /actions", Need.CONTROL, REFUSED)
async def act_in_bring_up(bring_up: Provided[BringUpRun], order: BringUpOrder) -> BringUpState:
    """Perform an action of a step, and return its results."""
    await bring_up.perform(order.step, order.action, order.inputs, order.run)
    return bring_up.state()


@router.operation("POST /hands", Need.CONTROL, REFUSED)
async def use_hands_in_bring_up(bring_up: Provided[BringUpRun], order: HandsOrder) -> BringUpState:
    """Move or wire the emulated robot as a person's hands do; refused for a real robot."""
    await bring_up.use_hands(order)
    return bring_up.state()


@router.operation("GET /report", Need.VIEWER, NoReportError)
def get_bring_up_report(bring_up: Provided[BringUpRun]) -> HTMLResponse:
    """Return the newest report, as HTML."""
    return HTMLResponse(bring_up.report())
