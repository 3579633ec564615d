"""Schemas of tuning in the interface."""

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import Field, FiniteFloat

from robot_runtime.contract.commands import (
    ExperimentCommand,
    RelayExperimentCommand,
    StepExperimentCommand,
)
from robot_runtime.contract.documents import ExperimentKind, ExperimentPhase
from robot_runtime.contract.limits import (
    ConfigError,
    ExperimentSeconds,
    LoopName,
    RelayAmplitude,
    RelayCycles,
    SettleSeconds,
)
from robot_runtime.errors import RefusedError
from server.features.tuning.curve import TuningCurve
from server.http.request_body import RequestBody
from server.metrics.figure import Figure, FigureMeaning
from server.platform.schema_base import Schema

ENDED = ("complete", "stopped", "failed")
"""The phases in which an experiment is over."""
RunState = Literal["running", "complete", "stopped", "failed", "interrupted"]
RunName = Annotated[str, Field(min_length=1, max_length=100)]
Value = Annotated[FiniteFloat, Field(ge=-20, le=20, description="m, of an angle rad")]


class Limits(RequestBody):
    """Limits of the value; once inside them, leaving them ends the experiment at once."""

    low: Value
    high: Value


class StepStart(Limits):
    """A step of a loop's set point."""

    kind: Literal["step"]
    loop: LoopName = "depth"
    start: Value
    target: Value
    tolerance: Annotated[
        FiniteFloat, Field(gt=0, le=20, description="largest distance from the start that counts as settled")
    ]
    settle: Annotated[SettleSeconds, Field(description="longest time at the start, s")]
    duration: Annotated[ExperimentSeconds, Field(description="s from the step on")]

    def command(self, run: int) -> ExperimentCommand:
        """Return the command that begins it. Raise RefusedError."""
        return _command(StepExperimentCommand, self, run)


class RelayStart(Limits):
    """A relay in place of a loop's controller."""

    kind: Literal["relay"]
    loop: LoopName = "depth"
    set_point: Value
    amplitude: Annotated[RelayAmplitude, Field(description="d, share of the largest command")]
    hysteresis: Annotated[FiniteFloat, Field(ge=0, le=20, description="ε, in the loop's unit")]
    cycles: Annotated[RelayCycles, Field(description="number of measured cycles")]
    duration: Annotated[ExperimentSeconds, Field(description="s after which it gives up")]

    def command(self, run: int) -> ExperimentCommand:
        """Return the command that begins it. Raise RefusedError."""
        return _command(RelayExperimentCommand, self, run)


def _command(cls: type[ExperimentCommand], start: Limits, run: int) -> ExperimentCommand:
    try:
        return cls(number=run, **start.model_dump(exclude={"kind"}))
    except ConfigError as problem:
        raise RefusedError(str(problem)) from problem


Start = Annotated[StepStart | RelayStart, Field(discriminator="kind")]


class ControllerInForce(Schema):
    """The controller in force, with its gains."""

    controller: str
    title: str
    gains: dict[str, float]


class MeasuredLimitCycle(Schema):
    """Result of a relay experiment; medians over its cycles, values in the loop's unit."""

    cycles: int
    period: float = Field(description="ultimate period, s")
    swing: float = Field(description="a: half of the height from peak to peak")
    amplitude: float = Field(description="d: of the command, either way from the bias")
    bias: float = Field(description="mean command, which balances the load")
    asymmetry: float = Field(description="share of the cycle by which its halves differ; 0: none")
    ultimate_gain: float = Field(description="command for each unit of the loop")
    remarks: list[str] = Field(description="reasons to doubt these figures")


class Proposal(Schema):
    """Gains by a named rule."""

    rule: str
    title: str
    source: str
    known_for: str
    gains: dict[str, float]
    problem: str = Field(description="why these cannot be set; empty if they can")


class TuningRun(Schema):
    """A run, without its curve."""

    id: int
    name: str
    kind: ExperimentKind
    loop: LoopName
    started: datetime
    state: RunState
    problem: str = Field(description="why it did not complete")
    settings: dict[str, Any] = Field(description="the request that started it")
    force: ControllerInForce
    figures: dict[str, Figure] = Field(description="of a step response, by name")
    cycle: MeasuredLimitCycle | None = Field(description="of a relay experiment")


class TuningRunDetail(TuningRun):
    """A run with its curve and proposals."""

    curve: TuningCurve
    proposals: list[Proposal] = Field(description="of a relay experiment: gains of a PID by several rules")


class TuningRuns(Schema):
    """The runs on a loop, newest first, and the meanings of their figures."""

    figures: list[FigureMeaning]
    runs: list[TuningRun]


class TuningStarted(Schema):
    """The number of the started run."""

    run: int


class TuningName(RequestBody):
    """A run's new name."""

    name: RunName


class ActiveTuning(Schema):
    """The active run."""

    run: int
    kind: ExperimentKind
    loop: LoopName
    phase: ExperimentPhase
    began: float = Field(description="s, steady clock")
    since: float = Field(description="s, steady clock, when its phase began")
    progress: float
    cycles: int
    settings: dict[str, Any]


class TuningState(Schema):
    """The active run, and the last one since the server's start."""

    active: ActiveTuning | None
    last: TuningRun | None


class PredictionQuery(RequestBody):
    """A step, with the controller and the gains by which it is predicted."""

    step: StepStart
    controller: str
    gains: dict[str, FiniteFloat] = Field(description="by name; what is left out has its default")


class PredictedStep(Schema):
    """A predicted step response: at most 30 s after the step."""

    model: str = Field(description="title of the craft that was simulated")
    problem: str = Field(description="why it ended early; empty if it did not")
    figures: dict[str, Figure] = Field(description="by name, as of a run")
    curve: TuningCurve
