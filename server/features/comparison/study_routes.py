"""The study of one session: spectra, and one signal against another."""

from typing import Annotated

from fastapi import Query
from fastapi.responses import Response

from server.analysis.schemas import SignalName
from server.analysis.story_schemas import SPECTRA_MAX, SignalPair, Spectrum, StudyQuery
from server.features.comparison.parts import PartEnd, PartStart, read_part
from server.features.comparison.worker import ComparisonError, ComparisonWorker
from server.http.dependencies import Provided
from server.http.heavy_requests import ReadingTurn, TooManyHeavyError
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.platform.errors import InvalidError

router = Operations(prefix="/api", tags=["sessions"])

_ERRORS = (
    {404: "There is no such session, or it has no such signal"},
    TooManyHeavyError,
    ComparisonError,
    InvalidError,
)


@router.operation("GET /sessions/{session}/spectrum", Need.VIEWER, *_ERRORS, response_model=list[Spectrum])
async def get_spectrum(
    _: ReadingTurn,
    worker: Provided[ComparisonWorker],
    session: Identifier,
    signals: Annotated[
        list[SignalName], Query(alias="signal", min_length=1, max_length=SPECTRA_MAX, description="by name")
    ],
    start: PartStart = None,
    end: PartEnd = None,
) -> Response:
    """Return the spectra of signals by Welch's method, of a part of the time or of all of it."""
    query = StudyQuery(session=session, signals=list(dict.fromkeys(signals)), part=read_part(start, end))
    return Response(await worker.ask("spectrum", query.model_dump_json()), media_type="application/json")


@router.operation("GET /sessions/{session}/pair", Need.VIEWER, *_ERRORS, response_model=SignalPair)
async def get_pair(
    _: ReadingTurn,
    worker: Provided[ComparisonWorker],
    session: Identifier,
    x: SignalName,
    y: SignalName,
    start: PartStart = None,
    end: PartEnd = None,
) -> Response:
    """Return one signal against another, at the same times."""
    query = StudyQuery(session=session, signals=[x, y], part=read_part(start, end))
    return Response(await worker.ask("pair", query.model_dump_json()), media_type="application/json")
