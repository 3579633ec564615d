"""The plan of a mission: when each step is expected to begin and end, and at which depths, if none fails.

It is an estimate for a picture. A trial in simulated water (`experiments/mission_trial`) shows more.
"""

from dataclasses import dataclass, replace

from robot_runtime.missions.branches import (
    AllBranch,
    FirstOfBranch,
    InvertBranch,
    RaceBranch,
    RepeatBranch,
    UntilBranch,
)
from robot_runtime.missions.document import MissionDocument, MissionStep
from robot_runtime.missions.leaf import Leaf

STEPS_MAX = 400
"""Of one plan: a `repeat` may do its steps a thousand times."""
UNKNOWN_SECONDS = 5.0
"""s for which a step is drawn whose end depends on what happens."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedStep:
    """One doing of a leaf. Times in s since the mission's start, depths in m; `path` as in documents.

    `known` is false where its end depends on what happens; it is drawn `UNKNOWN_SECONDS` long.
    """

    path: str
    start: float
    end: float
    start_depth: float
    end_depth: float
    known: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionPlan:
    """The leaves in the order of their beginnings; `complete` is false where `STEPS_MAX` cut it off."""

    steps: list[PlannedStep]
    complete: bool


def plan_mission(mission: MissionDocument) -> MissionPlan:
    """Return the plan of a mission that begins at the surface."""
    walk = _Walk()
    walk.add(mission.root)
    return MissionPlan(steps=sorted(walk.steps, key=lambda step: step.start), complete=not walk.full)


class _Walk:
    """A walk through the steps, with the time (s) and the depth (m) that it has reached."""

    def __init__(self, time: float = 0.0, depth: float = 0.0, room: int = STEPS_MAX) -> None:
        self.time, self.depth = time, depth
        self.steps: list[PlannedStep] = []
        self._room = room

    @property
    def full(self) -> bool:
        """True where no more steps are taken."""
        return len(self.steps) >= self._room

    def add(self, step: MissionStep) -> None:
        """Walk through a step and all below it."""
        if self.full:
            return
        node = step.node
        match node:
            case Leaf():
                self._add_leaf(step, node)
            case FirstOfBranch():
                self.add(step.steps[0])
            case InvertBranch():
                pass
            case RepeatBranch(times=times):
                self._add_rounds(step, times)
            case UntilBranch():
                self._add_until(step)
            case AllBranch() | RaceBranch():
                self._add_beside(step)
            case _:
                self._add_in_order(step.steps)

    def _add_leaf(self, step: MissionStep, leaf: Leaf) -> None:
        seconds, depth = leaf.estimate(self.depth)
        end = self.time + (min(UNKNOWN_SECONDS, leaf.longest) if seconds is None else seconds)
        self.steps.append(
            PlannedStep(
                path=step.number,
                start=self.time,
                end=end,
                start_depth=self.depth,
                end_depth=depth,
                known=seconds is not None,
            )
        )
        self.time, self.depth = end, depth

    def _add_in_order(self, steps: tuple[MissionStep, ...]) -> None:
        for step in steps:
            self.add(step)

    def _add_rounds(self, step: MissionStep, times: int) -> None:
        for _ in range(times):
            before = len(self.steps)
            self._add_in_order(step.steps)
            if self.full or len(self.steps) == before:
                return

    def _add_until(self, step: MissionStep) -> None:
        """Add one round of the steps: how many it takes depends on what happens."""
        before = len(self.steps)
        self._add_in_order(step.steps[1:])
        self.steps[before:] = [replace(step, known=False) for step in self.steps[before:]]

    def _add_beside(self, step: MissionStep) -> None:
        """Add steps that begin together; a race ends with the first."""
        walks = []
        for child in step.steps:
            walk = _Walk(self.time, self.depth, self._room - len(self.steps))
            walk.add(child)
            self.steps += walk.steps[: self._room - len(self.steps)]
            walks.append(walk)
        ends = [walk.time for walk in walks]
        end = min(ends) if isinstance(step.node, RaceBranch) else max(ends)
        steering = [walk for walk, child in zip(walks, step.steps, strict=True) if "depth" in child.steers]
        self.steps = [cut for planned in self.steps if (cut := _cut(planned, end)) is not None]
        self.depth = _depth_at(steering[0].steps, end, self.depth) if steering else self.depth
        self.time = end


def _cut(step: PlannedStep, end: float) -> PlannedStep | None:
    """Return a step as far as it is over at `end` (s); None where it begins later."""
    if step.end <= end:
        return step
    return None if step.start >= end else replace(step, end=end, end_depth=_depth_of(step, end))


def _depth_at(steps: list[PlannedStep], time: float, before: float) -> float:
    begun = [step for step in steps if step.start <= time]
    return _depth_of(begun[-1], time) if begun else before


def _depth_of(step: PlannedStep, time: float) -> float:
    share = 1.0 if step.end <= time else (time - step.start) / (step.end - step.start)
    return step.start_depth + share * (step.end_depth - step.start_depth)
