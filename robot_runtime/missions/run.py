"""One run of a mission: its clock, what it overrides and sets, and its state as documents."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import inf

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import (
    MISSION_MARK,
    Event,
    Mission,
    MissionStepState,
    ParameterValue,
)
from robot_runtime.contract.missions import MissionPhase, MissionStatus
from robot_runtime.control.loop import LoopOverride
from robot_runtime.control.node import Course
from robot_runtime.missions.branches import (
    AllBranch,
    FirstOfBranch,
    RaceBranch,
    RepeatBranch,
    TimeoutBranch,
    UntilBranch,
)
from robot_runtime.missions.document import MissionDocument, MissionStep
from robot_runtime.missions.failure import find_failed
from robot_runtime.missions.leaf import Leaf
from robot_runtime.missions.senses import MissionSenses
from robot_runtime.missions.tree import MissionTree
from robot_runtime.parameters.registry import Registry

COURSE_LEASE = 0.3
"""s after which a course expires."""


@dataclass(slots=True)
class _Record:
    """The status of a step; its longest duration (s), the clock at its start, and its duration (s)."""

    longest: float
    status: MissionStatus = "waiting"
    began: float = 0.0
    took: float = 0.0
    seen: object = None
    """Its behaviour's status when this was written."""
    reset: bool = False
    """True if it has ended, and its behaviour knows nothing of it any more."""


class MissionRun:
    """A mission that has begun, as the leaves see it; the control loop calls `tick`."""

    def __init__(
        self,
        document: MissionDocument,
        text: str,
        number: int,
        clock: Clock,
        senses: MissionSenses,
        parameters: Registry,
        on_event: Callable[[Event], None],
    ) -> None:
        self.document = document
        self.surfaced = False
        self.elapsed = 0.0
        """s that it has run, without its pauses."""
        self.paused = 0.0
        """s that it has been paused."""
        self.deepest = senses.depth
        self._text = text
        self._number = number
        self._clock = clock
        self._senses = senses
        self._parameters = parameters
        self._on_event = on_event
        self._before: dict[str, tuple[ParameterValue, ParameterValue]] = {}
        limits = senses.control.depth.limits
        self._depth = min(max(senses.depth, limits.minimum), limits.maximum)
        self._heading: float | None = None
        self._course = Course(-inf)
        self._sequence = 0
        self._progress = 0.0
        self._records = {step.path: _Record(step.longest) for step in document.root.walk()}
        self._alternatives = {
            step.path: tuple(following.path for following in branch.steps[number:])
            for branch in document.root.walk()
            if isinstance(branch.node, FirstOfBranch)
            for number, step in enumerate(branch.steps, 1)
        }
        """The later steps beside each step of a `first_of`, whose start resets the ones before."""
        self._tree = MissionTree(document.root, self)

    @property
    def now(self) -> float:
        """The time (s) since its start, without its pauses."""
        return self.elapsed

    @property
    def depth(self) -> float:
        """The depth, m."""
        return self._senses.depth

    @property
    def heading(self) -> float:
        """The heading, rad."""
        return self._senses.heading

    @property
    def way(self) -> tuple[float, float]:
        """The way since arming by dead reckoning, m along headings 0 and 90°."""
        return self._senses.way

    @property
    def battery(self) -> float | None:
        """The battery's voltage, V; None where it is not measured."""
        return self._senses.battery

    @property
    def light(self) -> bool:
        """True while a detector sees the light."""
        return self._senses.light

    @property
    def depth_held(self) -> float:
        """The depth, m."""
        return self._depth

    @property
    def heading_held(self) -> float | None:
        """The held heading, rad; None where none is held."""
        return self._heading

    def sees(self, what: str) -> bool:
        """Return True if this colour, marker or light is seen now."""
        return self._senses.sees(what)

    def hold_depth(self, depth: float) -> None:
        """Hold this depth, m, from now on."""
        self._depth = depth

    def hold_heading(self, heading: float | None) -> None:
        """Hold this heading, rad, or none, from now on."""
        self._heading = heading

    def swim(self, x: float, yaw: float) -> None:
        """Set the course until it expires."""
        self._course = Course(self._clock.now() + COURSE_LEASE, x, yaw)

    def swim_to_light(self) -> None:
        """Set the course to the light until it expires."""
        self._course = Course(self._clock.now() + COURSE_LEASE, by="beacons")

    def keep_still(self) -> None:
        """Rest the fins until the next tick."""
        self._course = Course(self._clock.now() + COURSE_LEASE, still=True)

    def count_down(self, remaining: float) -> None:
        """Rest the fins, and show the remaining time (s) by the LED, until the next tick."""
        self._course = Course(self._clock.now() + COURSE_LEASE, still=True, countdown=remaining)

    def set_parameter(self, name: str, value: ParameterValue) -> None:
        """Set a parameter and record its previous value. Raise RefusedError."""
        before = self._parameters.values().get(name, value)
        self._parameters.apply({name: value})
        first, _ = self._before.get(name, (before, value))
        self._before[name] = first, self._parameters.values()[name]

    def is_pending(self, name: str) -> bool:
        """Return True until the board confirms a parameter."""
        return self._parameters.is_pending(name)

    def mark(self, text: str) -> None:
        """Publish the marker, which the server puts into the session."""
        self._on_event(Event(time=self._clock.now(), kind=MISSION_MARK, severity="info", text=text))

    def surface(self) -> None:
        """End the mission after this tick."""
        self.surfaced = True

    def tick(self, seconds: float) -> MissionStatus:
        """Advance by `seconds`; override loops and course. Return the root's status."""
        self.elapsed += seconds
        self._course = Course(self._clock.now() + COURSE_LEASE)
        status = self._tree.tick()
        control = self._senses.control
        control.depth.override = LoopOverride(set_point=self._depth)
        heading = self._heading
        control.heading.override = None if heading is None else LoopOverride(set_point=heading)
        control.override_course(self._course)
        return status

    def rest(self) -> None:
        """Hold the depth and stay, or keep still as before, while the mission is paused in automatic."""
        control = self._senses.control
        control.depth.override = LoopOverride(set_point=self._depth)
        control.heading.override = None
        control.override_course(Course(self._clock.now() + COURSE_LEASE, still=self._course.still))

    def see_depth(self) -> None:
        """Note the deepest point."""
        self.deepest = max(self.deepest, self.depth)

    def skip(self) -> None:
        """Have the running leaves succeed."""
        self._tree.skip()

    def resume(self) -> None:
        """Have the running leaves go on after a pause."""
        self._tree.resume()

    def end(self) -> dict[str, ParameterValue]:
        """Stop the tree, take back the overrides, and put the parameters back.

        Return those that could not be put back with the values they should have. A parameter that somebody
        else has changed meanwhile stays.
        """
        self._update()
        self._tree.stop()
        for record in self._records.values():
            if record.status == "running":
                record.status, record.took = "stopped", self.elapsed - record.began
        self.release()
        there = self._parameters.values()
        back = {name: first for name, (first, own) in self._before.items() if there[name] == own}
        problems = self._parameters.apply(back, partly=True)
        return {name: back[name] for name in problems}

    def release(self) -> None:
        """Take back the overrides."""
        control = self._senses.control
        control.depth.override = control.heading.override = None
        control.override_course(None)

    def describe(
        self, phase: MissionPhase, text: str, *, whole: bool, surfaced: float | None = None
    ) -> Mission:
        """Return the mission's present state; `whole`: with its text."""
        going = phase in ("running", "paused")
        if going:
            self._update()
        remaining = self._remaining(self.document.root) if going else 0.0
        if going:
            self._progress = round(1.0 - remaining / self._records[self.document.root.path].longest, 4)
        elif phase == "succeeded":
            self._progress = 1.0
        sequence, self._sequence = self._sequence, self._sequence + 1
        return Mission(
            time=self._clock.now(),
            number=self._number,
            sequence=sequence,
            name=self.document.name,
            title=self.document.title,
            phase=phase,
            text=text,
            elapsed=round(self.elapsed, 3),
            remaining=round(remaining, 1),
            progress=self._progress,
            paused=round(self.paused, 3),
            pause=self.document.limits.pause,
            deepest=round(self.deepest, 3),
            steps=list(self._states()),
            document=self._text if whole else "",
            surfaced=surfaced,
        )

    @property
    def failure(self) -> str:
        """The reason of the failure: the step that failed, with its text."""
        self._update()
        step = find_failed(list(self._states()))
        if step is None or not step.text:
            return "A step failed."
        where = f"Step {step.path}, {step.words.lower()}" if step.path else "The mission"
        return f"{where}: {step.text}"

    @property
    def statuses(self) -> tuple[object, ...]:
        """The statuses of all steps; a change makes the next document due."""
        self._update()
        return *(record.status for record in self._records.values()), *self._tree.all_rounds

    def _update(self) -> None:
        behaviours = self._tree.behaviours
        for path, record in self._records.items():
            if (seen := behaviours[path].status) is record.seen and not record.reset:
                continue
            record.seen = seen
            status = self._tree.status(path)
            if is_reset := status == "waiting":
                status = self._find_past(path, record)
            record.reset = is_reset and status != "waiting"
            if status == record.status:
                continue
            if record.status != "running":
                record.began = self.elapsed
            if status != "running":
                record.took = self.elapsed - record.began
            record.status = status

    def _find_past(self, path: tuple[int, ...], record: _Record) -> MissionStatus:
        """Return the last status of a step whose behaviour is reset, until its branch begins anew."""
        branch = self._records[path[:-1]].status if path else "running"
        if record.status in ("running", "stopped"):
            return "waiting" if branch == "waiting" else "stopped"
        later = self._alternatives.get(path, ())
        if branch in ("done", "failed") or any(self._tree.status(path) != "waiting" for path in later):
            return record.status
        return "waiting"

    def _states(self) -> Iterator[MissionStepState]:
        for step in self.document.root.walk():
            record = self._records[step.path]
            elapsed = self.elapsed - record.began if record.status == "running" else record.took
            yield MissionStepState(
                path=step.number,
                do=step.node.do,
                words=step.node.label,
                note=step.node.note,
                status=record.status,
                elapsed=round(elapsed, 3),
                longest=round(record.longest, 1),
                rounds=self._tree.rounds(step.path),
                text=self._tree.text(step.path) if record.status != "waiting" else "",
            )

    def _remaining(self, step: MissionStep) -> float:
        """Return the longest remaining duration (s) of a step."""
        record = self._records[step.path]
        if record.status == "waiting":
            return record.longest
        if record.status != "running":
            return 0.0
        own = max(record.longest - (self.elapsed - record.began), 0.0)
        if isinstance(step.node, Leaf | UntilBranch):
            return own
        below = [self._remaining(child) for child in step.steps]
        if isinstance(step.node, AllBranch | RaceBranch):
            return max(below)
        if isinstance(step.node, RepeatBranch):
            rounds = step.node.times - self._tree.rounds(step.path)
            if any(self._records[child.path].status in ("waiting", "running") for child in step.steps):
                # The round that is under way; between two, the one before is counted already.
                rounds -= 1
            return rounds * record.longest / step.node.times + sum(below)
        return min(own, sum(below)) if isinstance(step.node, TimeoutBranch) else sum(below)
