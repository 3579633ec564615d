"""Requests and answers of the comparison of sessions."""

from math import isfinite
from typing import Annotated, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from server.analysis.alignment import Align
from server.analysis.decimation import Envelope
from server.analysis.differences import Difference
from server.analysis.signals import Signal
from server.http.request_body import RequestBody
from server.library.missions import MissionStepStart
from server.library.timeline import Moment
from server.metrics.figure import Figure, FigureMeaning
from server.metrics.series import Floats
from server.platform.models import IDENTIFIER_MAX

SESSIONS_MAX = 12
SIGNALS_MAX = 24
REPORT_POINTS = 2000
"""Columns of a report's charts; each has its least and its most value."""
DEFAULT_SIGNALS = ("depth.depth", "control.set_point", "control.error", "navigation.z", "detection.area")
"""The signals of the thesis's Figures 14 to 16."""

Identifier = Annotated[int, Field(ge=1, le=IDENTIFIER_MAX)]
SignalName = Annotated[str, Field(pattern=r"^[a-z_]{1,40}\.[a-z0-9_]{1,60}$")]


class TimeRange(RequestBody):
    """A time range, s on the common time axis, where the aligned moment is 0."""

    start: Annotated[float, Field(allow_inf_nan=False)]
    end: Annotated[float, Field(allow_inf_nan=False)]


class LinesQuery(RequestBody):
    """Sessions, their signals, and their alignment."""

    sessions: Annotated[list[Identifier], Field(min_length=1, max_length=SESSIONS_MAX)]
    signals: Annotated[list[SignalName], Field(max_length=SIGNALS_MAX)]
    align: Align = Align()
    points: Annotated[int, Field(ge=10, le=10_000, description="columns of each line")] = 1000
    view: TimeRange | None = Field(default=None, description="the drawn time range; all of it if null")


class ComparisonQuery(LinesQuery):
    """A comparison: lines, and the range of the figures."""

    range: TimeRange | None = Field(default=None, description="for the figures; the armed time if null")
    band: Annotated[float, Field(gt=0, le=10, description="m, of the settling time")] | None = None
    figures: bool = Field(default=True, description="false: none, and the answer comes sooner")


class StoryFiguresQuery(RequestBody):
    """A session, and the part of its time (s since its start) whose figures are wanted; all of it if null."""

    session: Identifier
    part: TimeRange | None = None


class ReportQuery(BaseModel):
    """A comparison as a query: lists with commas, moments in s on the common time axis."""

    model_config = ConfigDict(extra="forbid")
    sessions: Annotated[str, Field(pattern=r"^\d+(,\d+)*$", max_length=200)]
    signals: Annotated[str, Field(max_length=2500)] = "depth.depth,control.set_point"
    by: str = "start"
    number: int = 1
    marker: str = ""
    step: str = ""
    start: FiniteFloat | None = Field(default=None, description="start of the range for the figures")
    end: FiniteFloat | None = None
    view_start: FiniteFloat | None = Field(
        default=None, description="start of the part that the charts show first"
    )
    view_end: FiniteFloat | None = None

    def parse(self) -> ComparisonQuery:
        """Return the requested comparison. Raise ValidationError."""
        return ComparisonQuery.model_validate(
            {
                "sessions": [int(number) for number in self.sessions.split(",")],
                "signals": [name for name in self.signals.split(",") if name],
                "align": {"by": self.by, "number": self.number, "marker": self.marker, "step": self.step},
                "points": REPORT_POINTS,
                "range": _range(self.start, self.end),
            }
        )

    @property
    def shown(self) -> TimeRange | None:
        """The time range that the charts show first; None: all of it."""
        return _range(self.view_start, self.view_end)


def _range(start: float | None, end: float | None) -> TimeRange | None:
    return None if start is None or end is None else TimeRange(start=start, end=end)


def _values(values: Floats) -> list[float | None]:
    """Return null for NaN, which JSON lacks."""
    return [float(f"{value:.6g}") if isfinite(value) else None for value in values.tolist()]


class SignalLine(BaseModel):
    """A signal over time, decimated to minimum and maximum of each column; null breaks the line."""

    time: list[float] = Field(description="s since the session's start")
    low: list[float | None]
    high: list[float | None]

    @classmethod
    def of(cls, line: Envelope) -> Self:
        """Return a decimated signal, values with six significant digits."""
        return cls(time=np.round(line.time, 4).tolist(), low=_values(line.low), high=_values(line.high))


class SessionLines(BaseModel):
    """One session's lines."""

    id: int
    offset: float | None = Field(
        description="the moment that is 0 s, s since its start; null if it lacks that"
    )
    problem: str = Field(description="why it cannot be aligned; empty if it can")
    series: dict[str, SignalLine] = Field(description="by signal; missing signals are left out")


class Compared(SessionLines):
    """One session of a comparison."""

    name: str
    started: float = Field(description="UTC, s since 1970")
    duration: float = Field(description="s")
    state: str
    armed: list[tuple[float, float]] = Field(description="from and to, s since its start")
    set_point_steps: int = Field(description="number of changes of the set point while armed")
    mission_steps: list[MissionStepStart] = Field(
        description="the steps of its missions that began, each once, in the order of the document"
    )
    events: list[Moment]
    markers: list[Moment]
    range: list[tuple[float, float]] = Field(description="range of the figures")
    figures: dict[str, Figure] = Field(description="by name; empty if none were asked for")


class Lines(BaseModel):
    """The lines of a time range."""

    sessions: list[SessionLines]


class Comparison(BaseModel):
    """A comparison of sessions, in the requested order."""

    align: Align
    signals: list[Signal] = Field(description="the requested ones that at least one session has")
    sessions: list[Compared]
    figures: list[FigureMeaning]
    differences: list[Difference]
