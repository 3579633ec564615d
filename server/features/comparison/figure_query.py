"""One figure of many sessions: its distribution, its course over the years, and both by group."""

from bisect import bisect_right
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from itertools import groupby
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import ConfigDict, Field
from sqlalchemy import literal
from sqlmodel import col, select

from server.analysis.definitions import STORY_FIGURES
from server.library.listing import SessionSelection, conditions
from server.metrics.figure import FigureMeaning
from server.platform.models import SessionFiguresRow, SessionRow
from server.platform.schema_base import Schema
from server.platform.store import Reader

FigureName = Literal[
    "duration",
    "deepest",
    "rmse",
    "cycle_amplitude",
    "overshoot",
    "settling_time",
    "fin_strokes",
    "frames_lost",
    "alarms",
]
Group = Literal["none", "controller", "gains", "craft", "firmware", "software", "robot"]
GROUPS_MAX = 8
"""Groups that are told apart, those of most values; all others together are one."""
OTHERS = "all others"
BINS = 30
DAYS = {"day": 1.0, "week": 7.0, "month": 30.5, "year": 365.25}
PERIODS_MAX = 60
"""Points of the course: of days, else of weeks, months or years."""
BEST_SHOWN = 5


class FigureQuery(SessionSelection):
    """A figure of the selected sessions."""

    model_config = ConfigDict(extra="forbid", defer_build=False)
    figure: FigureName = "rmse"
    of: Annotated[
        Literal["session", "segment"],
        Field(
            description="a value of each session, or of each time with one controller, gains and set point"
        ),
    ] = "session"
    by: Group = "none"


class FigureGroup(Schema):
    """The values of one group: their number, and shares of them that are less."""

    name: str = Field(description="empty: not known")
    count: int
    least: float
    low: float = Field(description="a quarter of the values is less")
    median: float
    high: float = Field(description="a quarter of the values is more")
    greatest: float
    bins: list[int] = Field(description="values in each of the bins")


class FigurePeriod(Schema):
    """The values of the sessions of one period."""

    start: datetime = Field(description="UTC")
    count: int
    low: float
    median: float
    high: float


class FigureExample(Schema):
    """A session with a remarkable value."""

    session: int
    segment: int = Field(description="0: the whole session")
    name: str
    value: float


class FigureStudy(Schema):
    """One figure of many sessions."""

    meaning: FigureMeaning
    sessions: int = Field(description="sessions that match")
    waiting: int = Field(description="of these, those whose figures are still to be computed")
    count: int = Field(description="values")
    edges: list[float] = Field(description="of the bins, from the least value on; empty without values")
    groups: list[FigureGroup]
    period: Literal["day", "week", "month", "year"]
    course: list[FigurePeriod]
    least: list[FigureExample] = Field(description="sessions of the least values")
    greatest: list[FigureExample] = Field(description="sessions of the greatest values")


class _Value(NamedTuple):
    value: float
    session: int
    segment: int
    name: str
    started: float
    group: str


def study_figure(reader: Reader, query: FigureQuery) -> FigureStudy:
    """Return a figure of the selected sessions. Raise StoreError."""
    row = SessionFiguresRow
    chosen = [*conditions(query)]
    value: Any = getattr(row, query.figure)
    group: Any = _column(query.by)
    columns: list[Any] = [value, row.session_id, row.segment, SessionRow.name, SessionRow.started, group]
    there = select(*columns).join(SessionRow, col(SessionRow.id) == col(row.session_id)).where(*chosen)
    there = there.where(value.is_not(None), row.segment == 0 if query.of == "session" else row.segment > 0)
    counted = select(col(SessionRow.id), col(row.session_id).is_not(None)).outerjoin(
        row, (col(row.session_id) == col(SessionRow.id)) & (col(row.segment) == 0)
    )
    with reader.read() as database:
        connection = database.connection()
        values = [_Value(*entry) for entry in connection.execute(there)]
        made = [done for _, done in connection.execute(counted.where(*chosen))]
    values.sort()
    numbers = [entry.value for entry in values]
    edges = _edges(numbers)
    period = _choose_period(values)
    (meaning,) = (meaning for meaning in STORY_FIGURES if meaning.name == query.figure)
    return FigureStudy(
        meaning=meaning,
        sessions=len(made),
        waiting=made.count(False),
        count=len(values),
        edges=edges,
        groups=_groups(values, edges),
        period=period,
        course=_course(values, DAYS[period]),
        least=[_example(entry) for entry in values[:BEST_SHOWN]],
        greatest=[_example(entry) for entry in values[: -BEST_SHOWN - 1 : -1]],
    )


def quantile(ordered: Sequence[float], share: float) -> float:
    """Return the value below which this share of the ordered values lies, between its neighbours."""
    position = share * (len(ordered) - 1)
    at = int(position)
    after = ordered[min(at + 1, len(ordered) - 1)]
    return ordered[at] + (position - at) * (after - ordered[at])


def _column(by: Group) -> Any:
    columns: Mapping[str, Any] = {
        "none": literal(""),
        "controller": SessionFiguresRow.controller,
        "gains": SessionFiguresRow.gains,
        "craft": SessionFiguresRow.craft,
        "firmware": SessionRow.firmware,
        "software": SessionRow.software,
        "robot": SessionRow.robot,
    }
    return columns[by]


def _edges(ordered: Sequence[float]) -> list[float]:
    if not ordered:
        return []
    # A few outliers must not squeeze all others into one bin: they are in the outermost ones.
    low, high = quantile(ordered, 0.01), quantile(ordered, 0.99)
    if high <= low:
        low, high = ordered[0] - 0.5, ordered[-1] + 0.5
    return [low + (high - low) * position / BINS for position in range(BINS + 1)]


def _groups(values: Sequence[_Value], edges: Sequence[float]) -> list[FigureGroup]:
    common = [name for name, _ in Counter(entry.group for entry in values).most_common(GROUPS_MAX)]
    by_name: defaultdict[str, list[float]] = defaultdict(list)
    for entry in values:
        by_name[entry.group if entry.group in common else OTHERS].append(entry.value)
    return [_describe(name, by_name[name], edges) for name in (*common, OTHERS) if name in by_name]


def _describe(name: str, ordered: Sequence[float], edges: Sequence[float]) -> FigureGroup:
    bins = [0] * BINS
    for value in ordered:
        bins[max(0, min(bisect_right(edges, value) - 1, BINS - 1))] += 1
    return FigureGroup(
        name=name,
        count=len(ordered),
        least=ordered[0],
        low=quantile(ordered, 0.25),
        median=quantile(ordered, 0.5),
        high=quantile(ordered, 0.75),
        greatest=ordered[-1],
        bins=bins,
    )


def _choose_period(values: Sequence[_Value]) -> Literal["day", "week", "month", "year"]:
    moments = [entry.started for entry in values]
    days = (max(moments) - min(moments)) / 86400 if moments else 0.0
    if days <= PERIODS_MAX * DAYS["day"]:
        return "day"
    if days <= PERIODS_MAX * DAYS["week"]:
        return "week"
    return "month" if days <= PERIODS_MAX * DAYS["month"] else "year"


def _course(values: Sequence[_Value], days: float) -> list[FigurePeriod]:
    seconds = days * 86400
    timed = sorted(values, key=lambda entry: entry.started)
    course: list[FigurePeriod] = []
    for number, some in groupby(timed, key=lambda entry: int(entry.started // seconds)):
        ordered = sorted(entry.value for entry in some)
        course.append(
            FigurePeriod(
                start=datetime.fromtimestamp(number * seconds, UTC),
                count=len(ordered),
                low=quantile(ordered, 0.25),
                median=quantile(ordered, 0.5),
                high=quantile(ordered, 0.75),
            )
        )
    return course


def _example(entry: _Value) -> FigureExample:
    return FigureExample(session=entry.session, segment=entry.segment, name=entry.name, value=entry.value)
