"""Sessions laid over each other."""

from typing import Annotated

from fastapi import APIRouter, Path, Query
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse, Response
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from server.features.comparison.comparisons import Comparisons
from server.features.comparison.schemas import Comparison, ComparisonQuery, Lines, LinesQuery, TimeRange
from server.features.comparison.signals import Signal
from server.features.sessions.session import UnknownSessionError
from server.http.dependencies import Provided
from server.http.operation import Operation
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.models import IDENTIFIER_MAX
from server.platform.store import StoreError

REPORT_POINTS = 2000
UNKNOWN = answers(UnknownSessionError, StoreError)

router = APIRouter(prefix="/api", tags=["comparison"], route_class=Operation)

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


class ReportQuery(BaseModel):
    """A comparison as a query: lists with commas, moments in s on the common time axis."""

    model_config = ConfigDict(extra="forbid")
    sessions: Annotated[str, Field(pattern=r"^\d+(,\d+)*$", max_length=200)]
    signals: Annotated[str, Field(max_length=2500)] = "depth.depth,control.set_point"
    by: str = "start"
    number: int = 1
    marker: str = ""
    start: float | None = Field(default=None, description="what the figures are taken over")
    end: float | None = None
    view_start: float | None = Field(default=None, description="what the charts show at first")
    view_end: float | None = None

    def parse(self) -> ComparisonQuery:
        """The comparison asked for. Raises ValidationError."""
        return ComparisonQuery.model_validate(
            {
                "sessions": self.sessions.split(","),
                "signals": [name for name in self.signals.split(",") if name],
                "align": {"by": self.by, "number": self.number, "marker": self.marker},
                "points": REPORT_POINTS,
                "range": _range(self.start, self.end),
            }
        )


def _range(start: float | None, end: float | None) -> TimeRange | None:
    return None if start is None or end is None else TimeRange(start=start, end=end)


@router.get(
    "/compare/report",
    openapi_extra=needs(Need.VIEWER),
    response_class=Response,
    responses={200: {"content": {"text/html": {}}, "description": "The file"}, **UNKNOWN},
)
def get_comparison_report(
    comparisons: Provided[Comparisons], query: Annotated[ReportQuery, Query()]
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
        write_report(comparison, _range(query.view_start, query.view_end)),
        headers={"content-disposition": f'attachment; filename="comparison_{name}.html"'},
    )


@router.get("/sessions/{session}/signals", openapi_extra=needs(Need.VIEWER), responses=UNKNOWN)
def list_signals(comparisons: Provided[Comparisons], session: Identifier) -> list[Signal]:
    """List the signals of a session: the columns of its topics, and numbers of its documents."""
    return comparisons.comparer.signals(session)


@router.post("/compare", openapi_extra=needs(Need.VIEWER), responses=UNKNOWN)
def compare_sessions(comparisons: Provided[Comparisons], body: ComparisonQuery) -> Comparison:
    """Compare sessions: lines, figures and differences."""
    return comparisons.comparer.compare(body)


@router.post("/compare/lines", openapi_extra=needs(Need.VIEWER), responses=UNKNOWN)
def compare_lines(comparisons: Provided[Comparisons], body: LinesQuery) -> Lines:
    """Return the lines of a shorter time range in full resolution."""
    return comparisons.comparer.lines(body)
