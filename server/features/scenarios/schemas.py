"""Schemas of scenarios."""

from typing import Annotated, Literal

from pydantic import Field

from robot_runtime.contract.problems import EntryProblem
from robot_runtime.contract.toml_text import BYTES_MAX
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.experiments.scenario.document import Scenario
from server.http.request_body import RequestBody
from server.platform.runs import RUN_MEANING
from server.platform.schema_base import Schema

Place = Literal["live", "simulated"]
BoardKind = Literal["host", "emulated"]
Phase = Literal["waiting", "preparing", "running", "ending"]
End = Literal["complete", "cancelled", "failed"]
Run = Annotated[str, Field(description=RUN_MEANING)]
Text = Annotated[str, Field(max_length=BYTES_MAX, description="TOML")]


class ScenarioText(Schema):
    """A scenario; `shipped` ones are part of the program, the others are in the data folder."""

    name: str
    title: str
    text: str = Field(description="TOML")
    mark: str = Field(description="tells this text from others")
    shipped: bool
    summary: "ScenarioSummary | None" = Field(description="null if it is not valid")


class ScenarioDocument(RequestBody):
    """The text of a scenario."""

    text: Text


class NewScenario(ScenarioDocument):
    """A scenario to be stored."""

    base: Annotated[str, Field(max_length=64)] | None = Field(
        default=None,
        description="`mark` of the text that the editing began from, empty for a new scenario: refused if "
        "somebody has changed it since. null replaces any",
    )


class ScenarioEvent(Schema):
    """An event of a scenario."""

    at: float = Field(description="s")
    do: str
    words: str


class ScenarioSummary(Schema):
    """The summary of a scenario."""

    name: str
    title: str
    description: str
    duration: float = Field(description="s")
    seed: int
    scene: Literal["pool", "natural"]
    controller: str = Field(description="title of the depth controller")
    events: list[ScenarioEvent]


EventFieldKind = Literal["number", "whole", "text", "switch", "choice", "value"]


class EventField(Schema):
    """A field of an event; a `value` is a list or a table, written as TOML."""

    name: str
    kind: EventFieldKind
    choices: list[str] = Field(description="of a choice; empty otherwise")
    meaning: str
    minimum: float | None
    maximum: float | None
    required: bool


class ScenarioEventKind(Schema):
    """A kind of event, beside its time."""

    do: str
    meaning: str
    fields: list[EventField]


class ScenarioCheck(Schema):
    """A scenario's problems, field by field, or its summary."""

    problems: list[EntryProblem]
    summary: ScenarioSummary | None


class ScenarioStart(RequestBody):
    """A scenario to run: on the robot in real time, or in simulated time.

    `board`, in simulated time alone: the firmware built for this computer, or on the emulated board.
    """

    text: Text
    place: Place
    board: BoardKind = "host"


class ScenarioStarted(Schema):
    """The run that was started."""

    run: Run


class ActiveRun(Schema):
    """The active run; times in s of the scenario."""

    run: Run
    name: str
    title: str
    place: Place
    board: BoardKind
    phase: Phase
    elapsed: float
    duration: float
    session: int | None
    next: ScenarioEvent | None
    events: list[ScenarioEvent]


class QueuedRun(Schema):
    """A queued run."""

    run: Run
    name: str
    title: str


class EndedRun(Schema):
    """The run that ended last; `session` is null if it recorded nothing."""

    run: Run
    name: str
    title: str
    place: Place
    session: int | None
    before: int | None = Field(description="the newest older session of the same scenario")
    state: End
    problem: str


class ScenarioState(Schema):
    """The active run, the queue and the last run."""

    active: ActiveRun | None
    queued: list[QueuedRun]
    last: EndedRun | None


def summarize(scenario: Scenario) -> ScenarioSummary:
    """Return the summary of a scenario."""
    controller = scenario.control.controller
    return ScenarioSummary(
        name=scenario.name,
        title=scenario.title,
        description=scenario.description,
        duration=scenario.duration,
        seed=scenario.seed,
        scene=scenario.scene.kind,
        controller=next(kind.title for kind in CONTROLLERS["depth"] if kind.name == controller),
        events=describe_events(scenario),
    )


def describe_events(scenario: Scenario) -> list[ScenarioEvent]:
    """Return the events of a scenario, in order."""
    return [ScenarioEvent(at=event.at, do=event.do, words=event.label) for event in scenario.events]
