"""Comparison of sessions."""

from typing import Annotated

from fastapi import Query
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse
from pydantic import ValidationError

from server.features.comparison.comparisons import Comparisons
from server.features.comparison.report_process import ReportError, make_report
from server.features.comparison.schemas import Comparison, ComparisonQuery, Lines, LinesQuery, ReportQuery
from server.features.comparison.signals import Signal
from server.features.sessions.session import UnknownSessionError
from server.http.dependencies import Provided
from server.http.heavy_requests import ReadingTurn, TooManyHeavyError, Turn
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.platform.settings import Settings

router = Operations(prefix="/api", tags=["comparison"])


@router.operation(
    "GET /compare/report",
    Need.VIEWER,
    UnknownSessionError,
    TooManyHeavyError,
    ReportError,
    media_type="text/html",
    linked=True,
)
async def get_comparison_report(
    _: Turn, settings: Provided[Settings], query: Annotated[ReportQuery, Query()]
) -> HTMLResponse:
    """Return a comparison as one HTML file with charts, figures and differences; it needs no network."""
    try:
        sessions = dict.fromkeys(query.parse().sessions)
    except ValidationError as problem:
        raise RequestValidationError(problem.errors()) from problem
    report = await make_report(settings.data.database, query)
    name = f"comparison_{'_'.join(map(str, sessions))}.html"
    return HTMLResponse(report, headers={"content-disposition": f'attachment; filename="{name}"'})


@router.operation("GET /sessions/{session}/signals", Need.VIEWER, UnknownSessionError)
def list_signals(comparisons: Provided[Comparisons], session: Identifier) -> list[Signal]:
    """List the signals of a session: the columns of its topics, and numbers of its documents."""
    return comparisons.comparer.signals(session)


@router.operation("POST /compare", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def compare_sessions(_: ReadingTurn, comparisons: Provided[Comparisons], body: ComparisonQuery) -> Comparison:
    """Compare sessions: lines, figures and differences."""
    return comparisons.comparer.compare(body)


@router.operation("POST /compare/lines", Need.VIEWER, UnknownSessionError, TooManyHeavyError)
def compare_lines(_: ReadingTurn, comparisons: Provided[Comparisons], body: LinesQuery) -> Lines:
    """Return the lines of a shorter time range in full resolution."""
    return comparisons.comparer.lines(body)
