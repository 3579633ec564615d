"""Requests and answers of sweeps."""

from typing import Annotated, Literal

from pydantic import Field

from robot_runtime.contract.problems import EntryProblem
from robot_runtime.contract.toml_text import BYTES_MAX
from server.driving.profiles import ProfileName
from server.http.request_body import RequestBody
from server.metrics.figure import FigureMeaning
from server.platform.schema_base import Schema

SweepState = Literal["running", "waiting", "complete", "cancelled", "failed", "interrupted"]
ParameterKind = Literal["list", "range", "random", "search"]
ParameterValue = float | int | str
LOOKED_UP_MAX = 5000


class SweepDocument(RequestBody):
    """The text of a sweep."""

    text: Annotated[str, Field(max_length=BYTES_MAX, description="TOML")]


class SweepTemplate(Schema):
    """A sweep to begin with."""

    text: str = Field(description="TOML")


class SweepStarted(Schema):
    """The sweep that was started."""

    sweep: int


class SweepParameter(Schema):
    """An entry of the scenario that varies."""

    name: str = Field(description="its path in the scenario")
    label: str
    unit: str
    values: list[ParameterValue] = Field(
        description="of a list, a range or samples; of one by the seed, of a search: the least, the most"
    )
    kind: ParameterKind
    by_seed: bool = Field(description="each seed draws its own value, the same in every variant")


class SweepPlan(Schema):
    """A sweep's problems, entry by entry, or what it will do."""

    problems: list[EntryProblem]
    runs: int
    variants: int
    parameters: list[SweepParameter]
    seconds: float | None = Field(
        description="that it takes, by the runs measured so far; null where none is"
    )
    workers: int = Field(description="runs that are computed at once; 0 where a scheduler decides")
    stored: int = Field(
        description=f"of its first {LOOKED_UP_MAX} runs, how many are computed already; of a search 0"
    )


class SweepBest(Schema):
    """The best variant by now: its values in the order of the parameters, the mean of the best figure."""

    variant: int
    values: list[ParameterValue | None]
    mean: float


class SweepHead(Schema):
    """A sweep. Times are UTC, s since 1970."""

    id: int
    name: str
    title: str
    scenario: str
    state: SweepState
    problem: str = Field(description="why it failed, or what it waits for; empty otherwise")
    runs: int
    done: int
    failed: int
    made: float
    started: float | None
    ended: float | None
    remaining: float | None = Field(description="s; null where not known")
    workers: int = Field(description="runs that are computed at once; 0 while it does not run")
    who: str
    best_figure: str


class SweepSummary(SweepHead):
    """A sweep in the list."""

    parameters: list[str] = Field(description="names")
    best: SweepBest | None


class FigureInterval(Schema):
    """The mean of a figure over the seeds, with its 95 % interval; null with one seed."""

    mean: float
    low: float | None
    high: float | None
    count: int


class SweepVariant(Schema):
    """A variant: its values in the order of the parameters, null where each seed draws its own."""

    number: int
    values: list[ParameterValue | None]
    runs: int
    failed: int
    within: bool = Field(description="all limits are kept")
    figures: dict[str, FigureInterval]


class FailureCount(Schema):
    """A reason for failed runs, and how many have it."""

    reason: str
    count: int


class NextBest(Schema):
    """The second best variant: by how much its figure exceeds the best one's, paired by equal seeds."""

    variant: int
    difference: float
    low: float | None
    high: float | None


class RankedBest(Schema):
    """The best variant with its 95 % interval."""

    variant: int
    mean: float
    low: float | None
    high: float | None
    next: NextBest | None


class SweepDetail(SweepHead):
    """A sweep with its document and what came of it by now."""

    text: str
    parameters: list[SweepParameter]
    figures: list[FigureMeaning]
    limits: dict[str, float] = Field(
        description="by figures: a variant whose mean is beyond one is not the best"
    )
    variants: list[SweepVariant]
    failures: list[FailureCount]
    best: RankedBest | None


class SweepRunDetail(Schema):
    """A run of a variant."""

    number: int
    variant: int
    seed: int
    values: list[ParameterValue]
    state: Literal["complete", "failed"]
    reason: str
    seconds: float = Field(description="that it took")
    figures: dict[str, float | None]
    session: int | None = Field(description="the session that was recorded of it; null without one")


class SweepProfile(RequestBody):
    """The variant whose gains are saved, and the name of the profile."""

    variant: Annotated[int, Field(ge=1)]
    name: ProfileName


class SessionRun(Schema):
    """The run of the scenario that makes a session."""

    run: str
