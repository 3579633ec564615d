"""Tuning: step responses and relay experiments on the running robot, and what is kept of them."""

from typing import Annotated

from fastapi import APIRouter, Path, Request
from fastapi.concurrency import run_in_threadpool

from server.container import Assembly
from server.features.operate.routes import COMMAND
from server.features.tuning.figure_definitions import meanings
from server.features.tuning.schemas import (
    LoopName,
    Start,
    TuningName,
    TuningRunDetail,
    TuningRuns,
    TuningStarted,
    TuningState,
)
from server.http.problems import answers
from server.platform.models import IDENTIFIER_MAX

UNKNOWN = answers(_404="There is no such run", _409="Refused now", _503="The database does not work")

router = APIRouter(prefix="/api/tuning", tags=["tuning"])

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


@router.get("/state", summary="What runs", operation_id="getTuningState")
async def get_state(request: Request) -> TuningState:
    """The run that is on, and the one that ended last, as on the live socket."""
    return Assembly.of(request).tuning.state()


@router.get("/runs", summary="The runs on a loop", operation_id="listTuningRuns")
def get_runs(request: Request, loop: LoopName = "depth") -> TuningRuns:
    """Newest first, without their curves; and what the figures of a step response are."""
    return TuningRuns(figures=meanings(loop), runs=list(Assembly.of(request).tuning.runs.list(loop)))


@router.post(
    "/runs", status_code=201, summary="Begin a run", operation_id="startTuningRun", responses=COMMAND
)
async def start(request: Request, wanted: Start) -> TuningStarted:
    """On the armed robot, in automatic. Afterwards the loop goes on as before."""
    return TuningStarted(run=await Assembly.of(request).tuning.start(wanted))


@router.post(
    "/stop",
    status_code=204,
    summary="Stop the run that is on",
    operation_id="stopTuningRun",
    responses=COMMAND,
)
async def stop(request: Request) -> None:
    """The robot stays armed, and goes on as before the run. What was measured so far is kept."""
    await Assembly.of(request).tuning.stop()


@router.get("/runs/{run}", summary="One run", operation_id="getTuningRun", responses=UNKNOWN)
def get_run(request: Request, run: Identifier) -> TuningRunDetail:
    """With its curve, and of a relay experiment with the gains that the rules propose."""
    return Assembly.of(request).tuning.runs.detail(run)


@router.patch("/runs/{run}", summary="Name a run", operation_id="renameTuningRun", responses=UNKNOWN)
async def rename(request: Request, run: Identifier, wanted: TuningName) -> TuningRunDetail:
    """Call it otherwise."""
    runs = Assembly.of(request).tuning.runs
    await runs.rename(run, wanted.name)
    return await run_in_threadpool(runs.detail, run)


@router.delete(
    "/runs/{run}", status_code=204, summary="Delete a run", operation_id="deleteTuningRun", responses=UNKNOWN
)
async def delete(request: Request, run: Identifier) -> None:
    """For good; refused while it runs."""
    await Assembly.of(request).tuning.delete(run)
