"""Comparison of sessions."""

from typing import Annotated

from fastapi import Query, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse, Response
from pydantic import ValidationError

from server.analysis.schemas import Comparison, ComparisonQuery, Lines, LinesQuery, ReportQuery
from server.analysis.signals import Signal
from server.features.comparison.worker import ComparisonError, ComparisonWorker
from server.http.dependencies import Provided
from server.http.heavy_requests import ReadingTurn, TooManyHeavyError, Turn, while_connected
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.recording.session import UnknownSessionError

router = Operations(prefix="/api", tags=["comparison"])


@router.operation(
    "GET /compare/report",
    Need.VIEWER,
    UnknownSessionError,
    TooManyHeavyError,
    ComparisonError,
    media_type="text/html",
    linked=True,
)
async def get_comparison_report(
    _: Turn, request: Request, worker: Provided[ComparisonWorker], query: Annotated[ReportQuery, Query()]
) -> HTMLResponse:
    """Return a comparison as one HTML file with charts, figures and differences; it needs no network."""
    try:
        sessions = dict.fromkeys(query.parse().sessions)
    except ValidationError as problem:
        raise RequestValidationError(problem.errors()) from problem
    report = await while_connected(request, worker.report(query.model_dump_json()))
    name = f"comparison_{'_'.join(map(str, sessions))}.html"
    return HTMLResponse(report, headers={"content-disposition": f'attachment; filename="{name}"'})


@router.operation(
    "GET /sessions/{session}/signals",
    Need.VIEWER,
    UnknownSessionError,
    ComparisonError,
    response_model=list[Signal],
)
async def list_signals(worker: Provided[ComparisonWorker], session: Identifier) -> Response:
    """List the signals of a session: the columns of its topics, and numbers in its documents."""
    return _json(await worker.ask("signals", str(session)))


@router.operation(
    "POST /compare",
    Need.VIEWER,
    UnknownSessionError,
    TooManyHeavyError,
    ComparisonError,
    response_model=Comparison,
)
async def compare_sessions(
    _: ReadingTurn, worker: Provided[ComparisonWorker], body: ComparisonQuery
) -> Response:
    """Compare sessions: lines, figures and differences."""
    return _json(await worker.ask("compare", body.model_dump_json()))


@router.operation(
    "POST /compare/lines",
    Need.VIEWER,
    UnknownSessionError,
    TooManyHeavyError,
    ComparisonError,
    response_model=Lines,
)
async def compare_lines(_: ReadingTurn, worker: Provided[ComparisonWorker], body: LinesQuery) -> Response:
    """Return the lines of a shorter time range in full resolution."""
    return _json(await worker.ask("lines", body.model_dump_json()))


def _json(data: bytes) -> Response:
    return Response(data, media_type="application/json")
