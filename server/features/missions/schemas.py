"""Schemas of missions."""

from dataclasses import asdict
from typing import Annotated, Literal

from pydantic import Field, JsonValue

from robot_runtime.contract.documents import ParameterValue
from robot_runtime.contract.missions import MissionPhase
from robot_runtime.contract.problems import EntryProblem
from robot_runtime.contract.toml_text import BYTES_MAX
from robot_runtime.missions.document import MissionDocument
from robot_runtime.missions.plan import plan_mission
from server.http.request_body import RequestBody
from server.platform.runs import RUN_MEANING
from server.platform.schema_base import Schema
from server.recording.schemas import Session

SEEDS_MAX = 100
MissionToml = Annotated[str, Field(max_length=BYTES_MAX, description="TOML")]


class MissionBody(RequestBody):
    """The text of a mission."""

    text: MissionToml


class NewMission(MissionBody):
    """A mission to be stored."""

    base: Annotated[str, Field(max_length=64)] | None = Field(
        default=None,
        description="`mark` of the version that the editing began from, empty for a new mission: refused if "
        "somebody has changed it since. null replaces any",
    )


class MissionStepSummary(Schema):
    """A step of a mission."""

    path: str = Field(description='from 1 along the branches, as "3.1.2"; empty for the first step')
    do: str
    words: str
    note: str
    longest: float = Field(description="s that it takes at most")


class MissionSummary(Schema):
    """The summary of a mission."""

    name: str
    title: str
    description: str
    longest: float = Field(description="s that it takes at most, without pauses")
    depth: float = Field(description="m; its limit")
    time: float = Field(description="s; its limit")
    battery: float = Field(description="V; its limit; 0: none")
    unwatched: float = Field(description="s; its limit; 0: none")
    alone: float = Field(description="s for which it may go on without the server")
    pause: float = Field(description="s that it may be paused in all")
    steps: list[MissionStepSummary]


class PlannedMissionStep(Schema):
    """One doing of a leaf, as it is expected if no step fails."""

    path: str = Field(description="of the step, as in its summary")
    start: float = Field(description="s since the mission's start")
    end: float = Field(description="s since the mission's start")
    start_depth: float = Field(description="m")
    end_depth: float = Field(description="m")
    known: bool = Field(description="false: its end depends on what happens, and is drawn 5 s on at most")


class MissionPlanned(Schema):
    """The planned depth over time."""

    steps: list[PlannedMissionStep] = Field(description="in the order of their beginnings")
    complete: bool = Field(description="false: it is longer, and the rest is left out")


class MissionText(Schema):
    """A mission; `shipped` ones are part of the program, the others are in the data folder."""

    name: str
    title: str
    text: str = Field(description="TOML")
    mark: str = Field(description="tells this text from others")
    shipped: bool
    versions: int
    summary: MissionSummary | None = Field(description="null if it is not valid")


class MissionVersion(Schema):
    """A version of the user's own mission."""

    version: int
    made: float = Field(description="s since 1970")
    author: str = Field(description="empty where it is not known")
    text: str = Field(description="TOML")


class MissionCheck(Schema):
    """A mission's problems by entry, or its summary."""

    problems: list[EntryProblem]
    summary: MissionSummary | None
    plan: MissionPlanned | None = Field(description="null if it is not valid")
    unseen: list[str] = Field(
        description="what steps wait to see and the robot with its vision settings cannot, each with the "
        "step's path; empty while the robot does not answer"
    )
    table: dict[str, JsonValue] | None = Field(description="what the TOML says; null where it is no TOML")


class NodeField(Schema):
    """A field of a leaf or a branch."""

    name: str
    kind: Literal["number", "whole", "text", "value", "sight", "parameter", "mission"]
    meaning: str
    unit: str
    minimum: float | None
    maximum: float | None
    required: bool
    default: ParameterValue | None


class MissionNodeKind(Schema):
    """A leaf or a branch that documents may have."""

    do: str
    branch: bool
    least: int = Field(description="steps below it at least")
    most: int | None = Field(description="steps below it at most; null: any")
    meaning: str
    fields: list[NodeField]


class PastMissionRun(Schema):
    """A run of a mission that a session recorded. Times are s since the session's start."""

    session: Session
    start: float
    end: float
    phase: MissionPhase = Field(description="still running where the recording lacks its end")
    text: str = Field(description="how it ended")
    elapsed: float = Field(description="s of the mission's clock")
    deepest: float = Field(description="m")


class TrialStart(RequestBody):
    """A mission to try, once for each seed from 1 on."""

    text: MissionToml
    seeds: Annotated[int, Field(ge=1, le=SEEDS_MAX)] = 20


class MissionTrialResult(Schema):
    """The outcome with one seed. `phase` is null where the mission did not begin; `text` says why."""

    seed: int
    phase: MissionPhase | None
    text: str
    elapsed: float = Field(description="s")
    deepest: float = Field(description="m")
    failed: str | None = Field(description="path of the step that failed")
    curve: list[float] = Field(description="depth, m, twice a second from its start to its end")


class MissionTrial(Schema):
    """The running trial, or the last one."""

    run: str = Field(description=f"{RUN_MEANING}; empty: there was none")
    name: str
    text: str = Field(description="the mission's TOML")
    running: bool
    seeds: int
    problem: str = Field(description="the reason of an early end; empty without one")
    results: list[MissionTrialResult]


def describe_plan(mission: MissionDocument) -> MissionPlanned:
    """Return the plan of a mission."""
    return MissionPlanned.model_validate(asdict(plan_mission(mission)))


def summarize_mission(mission: MissionDocument) -> MissionSummary:
    """Return the summary of a mission."""
    return MissionSummary(
        name=mission.name,
        title=mission.title,
        description=mission.description,
        longest=mission.longest,
        **asdict(mission.limits),
        steps=[
            MissionStepSummary(
                path=step.number,
                do=step.node.do,
                words=step.node.label,
                note=step.node.note,
                longest=step.longest,
            )
            for step in mission.root.walk()
        ],
    )
