"""Tuning: step responses and relay experiments on the running robot, and their stored runs."""

from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response

from robot_runtime.contract.limits import LoopName
from server.driving.changes import COMMAND_ERRORS
from server.features.tuning.figure_definitions import meanings
from server.features.tuning.predictor import PredictionError, StepPredictor
from server.features.tuning.runner import TuningRunner
from server.features.tuning.runs import UnknownTuningRunError
from server.features.tuning.schemas import (
    PredictedStep,
    PredictionQuery,
    Start,
    TuningName,
    TuningRunDetail,
    TuningRuns,
    TuningStarted,
    TuningState,
)
from server.http.dependencies import Provided
from server.http.heavy_requests import TooManyHeavyError, Turn
from server.http.operations import Identifier, MeantNumber, Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.errors import ConflictError

router = Operations(prefix="/api/tuning", tags=["tuning"])


@router.operation("GET /state", Need.VIEWER)
async def get_tuning_state(tuning: Provided[TuningRunner]) -> TuningState:
    """Return the active run and the last one, as on the live socket."""
    return tuning.state()


@router.operation("GET /runs", Need.VIEWER)
def list_tuning_runs(tuning: Provided[TuningRunner], loop: LoopName = "depth") -> TuningRuns:
    """List the runs on a loop without their curves, newest first, and the meanings of their figures."""
    return TuningRuns(figures=meanings(loop), runs=list(tuning.runs.list(loop)))


@router.operation("POST /runs", Need.CONTROL, *COMMAND_ERRORS, status_code=201)
async def start_tuning_run(tuning: Provided[TuningRunner], caller: Caller, body: Start) -> TuningStarted:
    """Start a run on the armed robot, in automatic; afterwards the loop goes on as before."""
    return TuningStarted(run=await tuning.start(caller.name, body))


@router.operation("POST /stop", Need.CONTROL, *COMMAND_ERRORS)
async def stop_tuning_run(tuning: Provided[TuningRunner], run: MeantNumber = None) -> None:
    """Stop the active run and store its measurements; the robot stays armed."""
    await tuning.stop(run)


@router.operation(
    "POST /prediction", Need.VIEWER, TooManyHeavyError, PredictionError, response_model=PredictedStep
)
async def predict_step(_: Turn, predictor: Provided[StepPredictor], body: PredictionQuery) -> Response:
    """Predict a step response by simulating it; the robot does nothing."""
    return Response(await predictor.predict(body), media_type="application/json")


@router.operation("GET /runs/{run}", Need.VIEWER, UnknownTuningRunError, ConflictError)
def get_tuning_run(tuning: Provided[TuningRunner], run: Identifier) -> TuningRunDetail:
    """Return a run with its curve, and the gains proposed from a relay experiment."""
    return tuning.runs.detail(run)


@router.operation("PATCH /runs/{run}", Need.OPERATOR, UnknownTuningRunError, ConflictError)
async def rename_tuning_run(
    tuning: Provided[TuningRunner], run: Identifier, body: TuningName
) -> TuningRunDetail:
    """Rename a run."""
    runs = tuning.runs
    await runs.rename(run, body.name)
    return await run_in_threadpool(runs.detail, run)


@router.operation("DELETE /runs/{run}", Need.OPERATOR, UnknownTuningRunError, ConflictError)
async def delete_tuning_run(tuning: Provided[TuningRunner], run: Identifier) -> None:
    """Delete a run for good; refused while it runs."""
    await tuning.delete(run)
