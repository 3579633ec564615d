"""Comparison of sessions."""

from typing import Annotated

from fastapi import Query
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse
from pydantic import ValidationError

from server.features.comparison.comparisons import Comparisons
from server.features.comparison.schemas import Comparison, ComparisonQuery, Lines, LinesQuery, ReportQuery
from server.features.comparison.signals import Signal
from server.features.sessions.session import UnknownSessionError
from server.http.dependencies import Provided
from server.http.heavy_requests import ReadingTurn, TooManyHeavyError, Turn
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api", tags=["comparison"])


@router.operation(
    "GET /compare/report", Need.VIEWER, UnknownSessionError, TooManyHeavyError, media_type="text/html"
)
def get_comparison_report(
    _: Turn, comparisons: Provided[Comparisons], query: Annotated[ReportQuery, Query()]
) -> HTMLResponse:
    """Return a comparison as one HTML file with charts, figures and differences; it needs no network."""
    from server.features.comparison.report import write_report  # Plotly is not needed before

    try:
        body = query.parse()
    except ValidationError as problem:
        raise RequestValidationError(problem.errors()) from problem
    comparison = comparisons.comparer.compare(body)
    name = "_".join(str(one.id) for one in comparison.sessions)
    return HTMLResponse(
        write_report(comparison, query.shown),
        headers={"content-disposition": f'attachment; filename="comparison_{name}.html"'},
    )


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
