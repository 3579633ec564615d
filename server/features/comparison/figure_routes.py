"""One figure of many sessions."""

from typing import Annotated

from fastapi import Query

from server.features.comparison.figure_query import FigureQuery, FigureStudy, study_figure
from server.http.dependencies import Provided
from server.http.heavy_requests import ReadingTurn, TooManyHeavyError
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.platform.store import Store

router = Operations(prefix="/api", tags=["comparison"])


@router.operation("GET /figures", Need.VIEWER, TooManyHeavyError)
def get_figure_study(
    _: ReadingTurn, store: Provided[Store], query: Annotated[FigureQuery, Query()]
) -> FigureStudy:
    """Return one figure of all sessions that match: its distribution and its course over the time, by group.

    A lab computes the figures of its archive; a robot has none.
    """
    return study_figure(store, query)
