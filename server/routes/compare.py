"""Sessions laid over each other."""

from typing import Annotated

from fastapi import APIRouter, Path, Request

from server.assembly import Assembly
from server.comparison.shapes import Comparison, Lines, Wanted, WantedComparison
from server.comparison.signals import Signal
from server.routes.problems import answers
from server.sessions import IDENTIFIER_MAX

UNKNOWN = answers(_404="There is no such session", _503="The database does not work")

router = APIRouter(prefix="/api", tags=["comparison"])

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


@router.get(
    "/sessions/{session}/signals",
    summary="What of a session can be drawn over time",
    operation_id="listSignals",
    responses=UNKNOWN,
)
def get_signals(request: Request, session: Identifier) -> list[Signal]:
    """The columns of its topics that have samples, and numbers of its documents."""
    return Assembly.of(request).comparer.signals(session)


@router.post(
    "/compare", summary="Lay sessions over each other", operation_id="compareSessions", responses=UNKNOWN
)
def compare(request: Request, wanted: WantedComparison) -> Comparison:
    """Lines, figures and what was different about the sessions."""
    return Assembly.of(request).comparer.compare(wanted)


@router.post(
    "/compare/lines", summary="Lines for a part of the time", operation_id="compareLines", responses=UNKNOWN
)
def lines(request: Request, wanted: Wanted) -> Lines:
    """What is fetched when somebody looks closer."""
    return Assembly.of(request).comparer.lines(wanted)
