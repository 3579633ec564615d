"""One mission in simulated time, seed by seed: its outcome, duration and greatest depth."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from math import ceil, pi
from random import Random
from typing import Any

from robot_runtime.contract.commands import MissionCommand
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, Craft, CraftDocument
from robot_runtime.contract.documents import Control, MissionStepState
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.missions import MissionLimits, MissionPhase
from robot_runtime.contract.parsing import TOP
from robot_runtime.contract.problems import EntryProblem
from robot_runtime.contract.topics import CONTROL, MISSION
from robot_runtime.experiments.scenario.document import DURATION, MISSION_AT, Scenario, read_scenario_table
from robot_runtime.experiments.scenario.events import CommandEvent
from robot_runtime.experiments.scenario.rig import MakeBoard
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.missions.document import read_mission
from robot_runtime.missions.failure import find_failed
from robot_runtime.transport.blocks import read_blocks, read_rows

CURVE_PERIOD = 0.5
"""s between two points of a depth curve."""
OWN = ("name", "title", "duration", "seed", "mission", "missions", "description")
"""Entries of a scenario that are the trial's own."""
_POOL = {"kind": "pool", "depth": 3.0, "length": 10.0, "width": 5.0}
_MARGIN = 10.0
"""s after the mission's longest time, for arming and the end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialResult:
    """The outcome of a mission with one seed. `phase` is null where it did not begin; `text` is the reason.

    `failed` is the path of the step by which it failed, empty for the mission's own; null where none did, as
    at a limit. `curve` has the depth, m, every `CURVE_PERIOD` s from its start to its end.
    """

    seed: int
    phase: MissionPhase | None
    text: str
    elapsed: float = 0.0
    deepest: float = 0.0
    failed: str | None = None
    curve: list[float] = field(default_factory=list)


def trial_scenario(
    text: str, library: Mapping[str, str], limits: MissionLimits, seed: int, craft: Craft
) -> Scenario:
    """Return the scenario in which a mission is tried: its own `trial` entries, else a pool of 3 m.

    Each seed has its own noise and, unless the trial says one, its own heading at the start. Raise
    ConfigError with the problems of the mission and of its trial.
    """
    mission = read_mission(text, library, limits)
    where = TOP.field("trial")
    problems = [where.key(name).problem("is the trial's own") for name in OWN if name in mission.trial]
    if problems:
        raise ConfigError(*problems)
    start = {"heading": Random(f"{seed} heading").uniform(-pi, pi)}
    own = mission.trial.get("start", {})
    table: dict[str, Any] = {
        "scene": _POOL,
        "craft": "robot",
        **mission.trial,
        "start": {**start, **own} if isinstance(own, dict) else own,
        "name": "trial",
        "title": "Trial",
        "seed": seed,
        "duration": min(ceil(mission.longest + mission.limits.pause + _MARGIN), DURATION.maximum),
        "missions": asdict(limits),
    }
    try:
        scenario = read_scenario_table(table, craft)
    except ConfigError as problem:
        raise ConfigError(
            *(
                EntryProblem(("trial", *problem.path), f"trial: {problem.text}", problem.words)
                for problem in problem.problems
            )
        ) from problem
    begin = CommandEvent(at=MISSION_AT, command=MissionCommand(text=text, library=dict(library)))
    return replace(scenario, events=tuple(sorted([*scenario.events, begin], key=lambda event: event.at)))


def try_mission(
    scenario: Scenario, make_board: MakeBoard, craft: CraftDocument = DEFAULT_DOCUMENT
) -> TrialResult:
    """Run a trial's scenario until its mission has ended. `craft` is what the robot knows of its hull.

    Raise BoardError, PortError.
    """
    watch = _Watch()
    run = ScenarioRun(scenario, make_board, watch, craft)
    watch.on_end = run.cancel
    run.perform(lambda _: {})
    last = watch.last
    if last is None or last["phase"] in ("running", "paused"):
        text = watch.problem or "It did not begin within the trial."
        return TrialResult(seed=scenario.seed, phase=None, text=text)
    return TrialResult(
        seed=scenario.seed,
        phase=last["phase"],
        text=last["text"],
        elapsed=last["elapsed"],
        deepest=last["deepest"],
        failed=_find_failed(last["steps"]) if last["phase"] == "failed" else None,
        curve=watch.curve,
    )


def _find_failed(steps: list[dict[str, Any]]) -> str | None:
    failed = find_failed([MissionStepState(**step) for step in steps])
    return None if failed is None else failed.path


class _Watch:
    """The reader of a run's output; it calls `on_end` with the mission's end."""

    def __init__(self) -> None:
        self.on_end: Callable[[], None] = lambda: None
        self.last: dict[str, Any] | None = None
        self.problem = ""
        self.curve: list[float] = []
        self._began: float | None = None

    def blocks(self, data: bytes) -> None:
        """Take the mission's documents and the depths."""
        for block in read_blocks(data):
            if block.topic is MISSION:
                documents = json.loads(block.payload)
                self.last = documents[-1]
                if self._began is None:
                    self._began = documents[0]["time"]
                if not self._is_running:
                    self.on_end()
            elif block.topic is CONTROL and self._began is not None and self._is_running:
                for time, record in read_rows(block):
                    due = self._began + len(self.curve) * CURVE_PERIOD
                    if isinstance(record, Control) and time >= due:
                        self.curve.append(round(record.depth, 2))

    @property
    def _is_running(self) -> bool:
        return self.last is not None and self.last["phase"] in ("running", "paused")

    def event(self, event: str, **more: Any) -> None:
        """Record a refusal."""
        if event == "ended" and more.get("problem"):
            self.problem = str(more["problem"])
