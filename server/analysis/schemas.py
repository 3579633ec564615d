"""Requests and answers of the comparison of sessions."""

from math import isfinite
from re import fullmatch
from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import ConfigDict, Field, FiniteFloat, model_validator

from server.analysis.alignment import Align
from server.analysis.differences import Difference
from server.analysis.likeness import Likeness
from server.analysis.segment import SEGMENTS_MAX, Segment
from server.analysis.signals import Signal
from server.http.request_body import RequestBody
from server.library.missions import MissionStepStart
from server.library.timeline import Moment
from server.metrics.figure import Figure, FigureMeaning
from server.platform.schema_base import Schema
from server.recording.schemas import SessionNumber

if TYPE_CHECKING:
    from server.analysis.decimation import Envelope
    from server.metrics.series import Floats

SESSIONS_MAX = 12
SIGNALS_MAX = 24
REPORT_POINTS = 2000
"""Columns of a report's charts; each has its least and its most value."""
DEFAULT_SIGNALS = ("depth.depth", "control.set_point", "control.error", "navigation.z", "detection.area")
"""The signals of the thesis's Figures 14 to 16."""

SEGMENTS = r"^(\d+:\d+(,\d+:\d+)*)?$"
"""Chosen segments as a text: 7:2,9:1."""

SignalName = Annotated[str, Field(pattern=r"^[a-z_]{1,40}\.[a-z0-9_]{1,60}$")]


class TimeRange(RequestBody):
    """A time range, s on the common time axis, where the aligned moment is 0."""

    start: Annotated[float, Field(allow_inf_nan=False)]
    end: Annotated[float, Field(allow_inf_nan=False)]


class SegmentChoice(RequestBody):
    """A segment of a session."""

    session: SessionNumber
    segment: Annotated[int, Field(ge=1, le=SEGMENTS_MAX, description="from 1 on, in order of time")]


class LinesQuery(RequestBody):
    """Sessions, their signals, and their alignment."""

    sessions: Annotated[list[SessionNumber], Field(min_length=1, max_length=SESSIONS_MAX)]
    signals: Annotated[list[SignalName], Field(max_length=SIGNALS_MAX)]
    align: Align = Align()
    points: Annotated[int, Field(ge=10, le=10_000, description="columns of each line")] = 1000
    view: TimeRange | None = Field(default=None, description="the drawn time range; all of it if null")
    segments: Annotated[list[SegmentChoice], Field(max_length=SESSIONS_MAX)] = Field(
        default=[], description="at most one of each session; of the others the one most alike"
    )

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        chosen = [choice.session for choice in self.segments]
        if len(set(chosen)) < len(chosen):
            raise ValueError("Choose one segment of each session.")
        if not set(chosen) <= set(self.sessions):
            raise ValueError("Choose segments of the compared sessions only.")
        return self


class ComparisonQuery(LinesQuery):
    """A comparison: lines, and the range of the figures."""

    over: Literal["armed", "segment"] = Field(
        default="armed", description="what the figures cover where `range` is null"
    )
    range: TimeRange | None = Field(default=None, description="for the figures")
    band: Annotated[float, Field(gt=0, le=10, description="m, of the settling time")] | None = None
    figures: bool = Field(default=True, description="false: none, and the answer comes sooner")


class StoryFiguresQuery(RequestBody):
    """A session, and the part of its time (s since its start) whose figures are wanted; all of it if null."""

    session: SessionNumber
    part: TimeRange | None = None


class ReportQuery(Schema):
    """A comparison as a query: lists with commas, moments in s on the common time axis."""

    model_config = ConfigDict(extra="forbid", defer_build=False)
    sessions: Annotated[str, Field(pattern=r"^\d+(,\d+)*$", max_length=200)]
    signals: Annotated[str, Field(max_length=2500)] = "depth.depth,control.set_point"
    by: str = "start"
    number: int = 1
    marker: str = ""
    step: str = ""
    start: FiniteFloat | None = Field(default=None, description="start of the range for the figures")
    end: FiniteFloat | None = None
    over: str = "armed"
    segments: Annotated[str, Field(pattern=SEGMENTS, max_length=200)] = Field(
        default="", description="as “7:2,9:1”: of session 7 the second, of session 9 the first"
    )
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
                "over": self.over,
                "segments": read_segments(self.segments),
            }
        )

    @property
    def shown(self) -> TimeRange | None:
        """The time range that the charts show first; None: all of it."""
        return _range(self.view_start, self.view_end)


def read_segments(text: str) -> list[SegmentChoice]:
    """Return the chosen segments of a text such as “7:2,9:1”. Raise ValueError."""
    if not fullmatch(SEGMENTS, text):
        raise ValueError("segments are written as 7:2,9:1, the second of session 7 and the first of 9.")
    pairs = [pair.split(":") for pair in text.split(",") if pair]
    return [SegmentChoice(session=int(session), segment=int(segment)) for session, segment in pairs]


def _range(start: float | None, end: float | None) -> TimeRange | None:
    return None if start is None or end is None else TimeRange(start=start, end=end)


def _values(values: "Floats") -> list[float | None]:
    """Return null for NaN, which JSON lacks."""
    return [float(f"{value:.6g}") if isfinite(value) else None for value in values.tolist()]


class SignalLine(Schema):
    """A signal over time, decimated to minimum and maximum of each column; null breaks the line."""

    time: list[float] = Field(description="s since the session's start")
    low: list[float | None]
    high: list[float | None]

    @classmethod
    def of(cls, line: "Envelope") -> Self:
        """Return a decimated signal, values with six significant digits."""
        return cls(time=line.time.round(4).tolist(), low=_values(line.low), high=_values(line.high))


class SessionLines(Schema):
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
    segments: list[Segment] = Field(description=f"in order of time, the first {SEGMENTS_MAX}")
    segment: int | None = Field(description="the chosen one, from 1 on; null without any")
    events: list[Moment]
    markers: list[Moment]
    range: list[tuple[float, float]] = Field(description="range of the figures")
    figures: dict[str, Figure] = Field(description="by name; empty if none were asked for")


class Lines(Schema):
    """The lines of a time range."""

    sessions: list[SessionLines]


class Comparison(Schema):
    """A comparison of sessions, in the requested order."""

    align: Align
    signals: list[Signal] = Field(description="the requested ones that at least one session has")
    sessions: list[Compared]
    figures: list[FigureMeaning]
    likeness: Likeness = Field(description="of what the figures cover")
    differences: list[Difference]
