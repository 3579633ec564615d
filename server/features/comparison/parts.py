"""A part of a session's time in an address: `from` and `to`, s since its start."""

from typing import Annotated

from fastapi import Query

from server.analysis.schemas import TimeRange
from server.library.opening import SECONDS_MAX
from server.platform.errors import InvalidError


def _seconds(name: str, which: str) -> object:
    return Query(
        alias=name,
        ge=0,
        le=SECONDS_MAX,
        allow_inf_nan=False,
        description=f"{which} of the part, s since the start",
    )


PartStart = Annotated[float | None, _seconds("from", "start")]
PartEnd = Annotated[float | None, _seconds("to", "end")]


def read_part(start: float | None, end: float | None) -> TimeRange | None:
    """Return the part, None for all of the time. Raise InvalidError where it has one end, or none between."""
    if start is None and end is None:
        return None
    if start is None or end is None:
        raise InvalidError("A part of the time needs both its start and its end: give from and to.")
    if end <= start:
        raise InvalidError(f"The end, {end:g} s, must be after the start, {start:g} s.")
    return TimeRange(start=start, end=end)
