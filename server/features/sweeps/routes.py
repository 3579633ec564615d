"""Sweeps: check, start, follow, results, resume, and what is done with a result."""

from typing import Annotated

from fastapi import Path, Query, Request
from fastapi.concurrency import run_in_threadpool
from starlette.responses import Response

from robot_runtime.contract.limits import ConfigError
from server.analysis.definitions import RUN_FIGURES
from server.driving.admission import admit
from server.driving.profiles import Profile
from server.features.sweeps.description import describe_parameters
from server.features.sweeps.library import SweepLibrary
from server.features.sweeps.results import count_failures, list_variants, rank
from server.features.sweeps.runner import SweepRunner
from server.features.sweeps.schemas import (
    SessionRun,
    SweepDetail,
    SweepDocument,
    SweepPlan,
    SweepProfile,
    SweepRunDetail,
    SweepStarted,
    SweepSummary,
    SweepTemplate,
)
from server.features.sweeps.store import SweepStore, UnknownSweepError
from server.features.sweeps.table import write_table
from server.http.dependencies import Provided
from server.http.heavy_requests import TooManyHeavyError, Turn
from server.http.operations import Identifier, Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.errors import NotFoundError

REFUSED = {409: "Refused now", 422: "The sweep cannot be run"}

router = Operations(prefix="/api/sweeps", tags=["sweeps"])

VariantNumber = Annotated[int | None, Query(ge=1, description="of this variant alone")]


@router.operation("GET", Need.VIEWER)
async def list_sweeps(store: Provided[SweepStore], runner: Provided[SweepRunner]) -> list[SweepSummary]:
    """List the newest sweeps, newest first."""
    return [runner.describe(row) for row in await run_in_threadpool(store.newest)]


@router.operation("POST /check", Need.VIEWER, TooManyHeavyError)
async def check_sweep(_: Turn, library: Provided[SweepLibrary], document: SweepDocument) -> SweepPlan:
    """Check a sweep: its problems entry by entry, or what it will do and how long that takes."""
    try:
        return await run_in_threadpool(library.plan, document.text)
    except ConfigError as problem:
        return SweepPlan(
            problems=list(problem.problems),
            runs=0,
            variants=0,
            parameters=[],
            seconds=None,
            workers=0,
            stored=0,
        )


@router.operation("POST", Need.OPERATOR, REFUSED, TooManyHeavyError, status_code=201)
async def start_sweep(
    _: Turn, request: Request, runner: Provided[SweepRunner], caller: Caller, document: SweepDocument
) -> SweepStarted:
    """Start a sweep, or queue it behind others. Runs that are computed already are not computed again."""
    planned = await run_in_threadpool(runner.read, document.text)
    # Access may have been revoked in the meantime.
    await admit(request)
    return SweepStarted(sweep=await runner.start(planned, caller.name))


@router.operation("GET /template", Need.VIEWER, NotFoundError)
def get_sweep_template(
    library: Provided[SweepLibrary], scenario: Annotated[str, Query(max_length=60)]
) -> SweepTemplate:
    """Return a sweep of a scenario to begin with."""
    return SweepTemplate(text=library.template(scenario))


@router.operation("GET /{sweep}", Need.VIEWER, UnknownSweepError, TooManyHeavyError)
async def get_sweep(
    _: Turn, library: Provided[SweepLibrary], runner: Provided[SweepRunner], sweep: Identifier
) -> SweepDetail:
    """Return a sweep with its variants, failures and best variant by now."""
    row, read, runs = await run_in_threadpool(library.open, sweep)
    summary = runner.describe(row)
    return await run_in_threadpool(
        lambda: SweepDetail(
            **summary.model_dump(exclude={"parameters", "best"}),
            text=row.text,
            parameters=describe_parameters(read),
            figures=[*RUN_FIGURES],
            limits=dict(read.figures.limits),
            variants=list_variants(read, runs),
            failures=count_failures(read, runs),
            best=rank(read, runs),
        )
    )


@router.operation("GET /{sweep}/runs", Need.VIEWER, UnknownSweepError, TooManyHeavyError, REFUSED)
def list_sweep_runs(
    _: Turn, library: Provided[SweepLibrary], sweep: Identifier, variant: VariantNumber = None
) -> list[SweepRunDetail]:
    """List the runs that are done; of many runs only those of one variant."""
    return library.list_runs(sweep, variant)


@router.operation(
    "GET /{sweep}/table",
    Need.VIEWER,
    UnknownSweepError,
    TooManyHeavyError,
    media_type="text/csv",
    linked=True,
)
def download_sweep_table(_: Turn, library: Provided[SweepLibrary], sweep: Identifier) -> Response:
    """Download the runs that are done as CSV: values and figures of each, to the last digit."""
    row, read, runs = library.open(sweep)
    headers = {"Content-Disposition": f'attachment; filename="sweep-{row.id}-{row.name}.csv"'}
    return Response(write_table(read, runs), media_type="text/csv", headers=headers)


@router.operation("POST /{sweep}/cancel", Need.OPERATOR, REFUSED)
async def cancel_sweep(runner: Provided[SweepRunner], sweep: Identifier) -> None:
    """End a sweep that runs or waits; what is done stays."""
    await runner.cancel(sweep)


@router.operation("POST /{sweep}/resume", Need.OPERATOR, UnknownSweepError, REFUSED)
async def resume_sweep(runner: Provided[SweepRunner], sweep: Identifier) -> None:
    """Go on with a sweep that ended before all its runs were done."""
    await runner.resume(sweep)


@router.operation("DELETE /{sweep}", Need.OPERATOR, UnknownSweepError, REFUSED)
async def delete_sweep(runner: Provided[SweepRunner], sweep: Identifier) -> None:
    """Delete a sweep. The figures of its runs stay for others that have the same."""
    await runner.remove(sweep)


@router.operation(
    "POST /{sweep}/runs/{run}/session", Need.OPERATOR, UnknownSweepError, REFUSED, status_code=201
)
async def record_sweep_run(
    library: Provided[SweepLibrary],
    caller: Caller,
    sweep: Identifier,
    run: Annotated[int, Path(ge=1, le=2**31)],
) -> SessionRun:
    """Run the scenario of a run once more, as a session."""
    text = await run_in_threadpool(library.scenario_text, sweep, run)
    return SessionRun(run=library.start_session(text, caller.name))


@router.operation("POST /{sweep}/profile", Need.OPERATOR, UnknownSweepError, REFUSED, status_code=201)
async def save_sweep_profile(
    library: Provided[SweepLibrary], caller: Caller, sweep: Identifier, body: SweepProfile
) -> Profile:
    """Save the gains and the controller of a variant as a profile of parameters."""
    return await library.save_profile(sweep, body.variant, body.name, caller.name)
