"""Identification of the craft: start, follow, cancel, adopt, undo."""

from server.features.identification.adoption import CraftAdoption
from server.features.identification.runner import IdentificationRunner
from server.features.identification.schemas import (
    CraftChange,
    IdentificationStart,
    IdentificationStarted,
    IdentificationState,
)
from server.http.dependencies import Provided
from server.http.operations import MeantRun, Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need

REFUSED = {409: "Refused now"}

router = Operations(prefix="/api/identification", tags=["identification"])


@router.operation("GET", Need.VIEWER)
async def get_identification(runner: Provided[IdentificationRunner]) -> IdentificationState:
    """Return the running fit, or the last one with its result, and the craft in force."""
    return runner.state()


@router.operation("POST", Need.OPERATOR, REFUSED, status_code=201)
async def start_identification(
    runner: Provided[IdentificationRunner], body: IdentificationStart
) -> IdentificationStarted:
    """Fit the craft in force to sessions; one fit runs at a time."""
    return IdentificationStarted(run=runner.start(body))


@router.operation("POST /cancel", Need.OPERATOR, REFUSED)
async def cancel_identification(runner: Provided[IdentificationRunner], run: MeantRun = None) -> None:
    """Cancel the running fit."""
    runner.cancel(run)


@router.operation("POST /adopt", Need.OPERATOR, REFUSED)
async def adopt_craft(
    runner: Provided[IdentificationRunner], caller: Caller, run: MeantRun = None
) -> CraftChange:
    """Adopt the craft of the last fit: write its file, restart the simulator, set the controller's gains."""
    return CraftChange(affected=await runner.adopt(caller.name, run))


@router.operation("POST /undo", Need.OPERATOR, REFUSED)
async def undo_craft(adoption: Provided[CraftAdoption], caller: Caller) -> CraftChange:
    """Restore the craft before the last adoption."""
    return CraftChange(affected=await adoption.undo(caller.name))
