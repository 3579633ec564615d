"""Tuning: step responses and relay experiments on the running robot, and what is kept of them."""

from typing import Annotated

from fastapi import APIRouter, Path
from fastapi.concurrency import run_in_threadpool

from robot_runtime.contract.limits import LoopName
from server.features.tuning.figure_definitions import meanings
from server.features.tuning.runner import TuningRunner
from server.features.tuning.runs import UnknownTuningRunError
from server.features.tuning.schemas import (
    Start,
    TuningName,
    TuningRunDetail,
    TuningRuns,
    TuningStarted,
    TuningState,
)
from server.http.dependencies import Provided
from server.http.problems import COMMAND, answers
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, needs
from server.platform.errors import ConflictError
from server.platform.models import IDENTIFIER_MAX
from server.platform.store import StoreError

UNKNOWN = answers(UnknownTuningRunError, ConflictError, StoreError)

router = APIRouter(prefix="/api/tuning", tags=["tuning"])

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


@router.get("/state", summary="What runs", operation_id="getTuningState", openapi_extra=needs(Need.VIEWER))
async def get_state(tuning: Provided[TuningRunner]) -> TuningState:
    """The run that is on, and the one that ended last, as on the live socket."""
    return tuning.state()


@router.get(
    "/runs", summary="The runs on a loop", operation_id="listTuningRuns", openapi_extra=needs(Need.VIEWER)
)
def get_runs(tuning: Provided[TuningRunner], loop: LoopName = "depth") -> TuningRuns:
    """Newest first, without their curves; and what the figures of a step response are."""
    return TuningRuns(figures=meanings(loop), runs=list(tuning.runs.list(loop)))


@router.post(
    "/runs",
    status_code=201,
    summary="Begin a run",
    operation_id="startTuningRun",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def start(tuning: Provided[TuningRunner], caller: Caller, body: Start) -> TuningStarted:
    """On the armed robot, in automatic. Afterwards the loop goes on as before."""
    return TuningStarted(run=await tuning.start(caller.name, body))


@router.post(
    "/stop",
    status_code=204,
    summary="Stop the run that is on",
    operation_id="stopTuningRun",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def stop(tuning: Provided[TuningRunner]) -> None:
    """The robot stays armed, and goes on as before the run. What was measured so far is kept."""
    await tuning.stop()


@router.get(
    "/runs/{run}",
    summary="One run",
    operation_id="getTuningRun",
    openapi_extra=needs(Need.VIEWER),
    responses=UNKNOWN,
)
def get_run(tuning: Provided[TuningRunner], run: Identifier) -> TuningRunDetail:
    """With its curve, and of a relay experiment with the gains that the rules propose."""
    return tuning.runs.detail(run)


@router.patch(
    "/runs/{run}",
    summary="Name a run",
    operation_id="renameTuningRun",
    openapi_extra=needs(Need.OPERATOR),
    responses=UNKNOWN,
)
async def rename(tuning: Provided[TuningRunner], run: Identifier, body: TuningName) -> TuningRunDetail:
    """Call it otherwise."""
    runs = tuning.runs
    await runs.rename(run, body.name)
    return await run_in_threadpool(runs.detail, run)


@router.delete(
    "/runs/{run}",
    status_code=204,
    summary="Delete a run",
    operation_id="deleteTuningRun",
    openapi_extra=needs(Need.OPERATOR),
    responses=UNKNOWN,
)
async def delete(tuning: Provided[TuningRunner], run: Identifier) -> None:
    """For good; refused while it runs."""
    await tuning.delete(run)
