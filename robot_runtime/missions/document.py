"""The document of a mission: TOML, read strictly; it reports all problems at once, by path of their step.

A step's path counts from 1 along the branches: "3.1.2" is the second step of the first step of the third.
docs/reference/missions.md lists everything that a document may contain.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields
from math import ceil
from typing import Any, Literal

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.missions import (
    LEVELS_MAX,
    NO_LIMITS,
    NODES_MAX,
    BatteryVolts,
    MissionAlone,
    MissionDepth,
    MissionLimits,
    MissionTime,
    PauseSeconds,
    UnwatchedSeconds,
)
from robot_runtime.contract.parsing import TOP, parse, read_value
from robot_runtime.contract.problems import DocumentEntry, EntryProblem
from robot_runtime.contract.toml_text import TomlError, read_toml
from robot_runtime.missions import leaves  # noqa: F401 - declares them
from robot_runtime.missions.branches import (
    AllBranch,
    CallBranch,
    InvertBranch,
    RaceBranch,
    RepeatBranch,
    TimeoutBranch,
    UntilBranch,
    WhileTrueBranch,
)
from robot_runtime.missions.leaf import INSTANT, NODES, Branch, Claim, Leaf, MissionNode
from robot_runtime.missions.leaves.asking import IsLeaf
from robot_runtime.missions.leaves.waiting import WaitUntilWetLeaf

NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,59}")
TITLE_MAX, DESCRIPTION_MAX = 100, 2000
_ROOT = DocumentEntry("mission", ("mission",))


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnLimits:
    """The limits that a document may tighten; without one the robot's applies."""

    depth: MissionDepth | None = None
    time: MissionTime | None = None
    battery: BatteryVolts | None = None
    unwatched: UnwatchedSeconds | None = None


@dataclass(frozen=True, slots=True)
class MissionStep:
    """A step with the steps below it; `called` is the name of the mission whose first step it is."""

    path: tuple[int, ...]
    node: MissionNode
    steps: tuple["MissionStep", ...] = ()
    called: str = ""

    @property
    def number(self) -> str:
        """The path as a person reads it; empty for the first step of a document."""
        return ".".join(map(str, self.path))

    def walk(self) -> Iterator["MissionStep"]:
        """Yield this step and all below it, in the order of the document."""
        yield self
        for step in self.steps:
            yield from step.walk()

    @property
    def steers(self) -> frozenset[Claim]:
        """The parts of the steering that this step or one below it takes."""
        own = self.node.steers if isinstance(self.node, Leaf) else frozenset()
        return own.union(*(step.steers for step in self.steps))

    @property
    def longest(self) -> float:
        """The longest duration (s)."""
        if isinstance(self.node, Leaf):
            return self.node.longest
        below = [step.longest for step in self.steps]
        match self.node:
            case UntilBranch(timeout=timeout):
                return timeout + INSTANT
            case TimeoutBranch(seconds=seconds):
                return min(seconds + INSTANT, sum(below))
            case RepeatBranch(times=times):
                return times * (sum(below) + INSTANT)
            case AllBranch() | RaceBranch():
                return max(below)
        return sum(below)


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionDocument:
    """A mission, checked; `limits` are those in force, of the robot, the document and what it calls."""

    name: str
    title: str
    description: str
    limits: MissionLimits
    root: MissionStep
    trial: Mapping[str, Any] = field(default_factory=dict)
    """The water to try it in: entries of a scenario."""

    @property
    def longest(self) -> float:
        """The longest duration (s), without pauses."""
        return self.root.longest


@dataclass(frozen=True, slots=True, kw_only=True)
class _Head:
    """The entries of a document without its steps."""

    format: Literal[1]
    name: str
    title: str = ""
    description: str = ""
    alone: MissionAlone = 0.0
    pause: PauseSeconds = 60.0

    def __post_init__(self) -> None:
        problems = []
        if not NAME.fullmatch(self.name):
            text = f"is {self.name!r}; it is 1 to 60 small letters, digits, - and _, as it names a file"
            problems.append(TOP.field("name").problem(text))
        if len(self.title) > TITLE_MAX:
            problems.append(TOP.field("title").problem(f"has more than {TITLE_MAX} characters"))
        if len(self.description) > DESCRIPTION_MAX:
            problems.append(TOP.field("description").problem(f"has more than {DESCRIPTION_MAX} characters"))
        if problems:
            raise ConfigError(*problems)


def read_mission(
    text: str, library: Mapping[str, str] | None = None, limits: MissionLimits = NO_LIMITS
) -> MissionDocument:
    """Return the mission in a TOML text. Raise ConfigError with all problems.

    `library` has the texts of the missions that it may call, by name; `limits` are the robot's.
    """
    return _Reading(library or {}, limits).read(text)


def called_by(text: str, library: Mapping[str, str]) -> dict[str, str]:
    """Return the texts of the existing missions that this one calls, directly or through others."""
    called: dict[str, str] = {}
    waiting = [text]
    while waiting:
        try:
            table = read_toml(waiting.pop())
        except TomlError:
            continue
        for name in _calls(table.get("mission"), 0):
            if name in library and name not in called:
                called[name] = library[name]
                waiting.append(library[name])
    return called


def _calls(step: Any, level: int) -> Iterator[str]:
    if not isinstance(step, dict) or level > LEVELS_MAX:
        return
    if step.get("do") == CallBranch.do and isinstance(step.get("mission"), str):
        yield step["mission"]
    steps = step.get("steps")
    for step in steps if isinstance(steps, list) else ():
        yield from _calls(step, level + 1)


class _Reading:
    """The reading of one document and of those that it calls; it counts nodes across all of them."""

    def __init__(self, library: Mapping[str, str], limits: MissionLimits) -> None:
        self._library = library
        self._limits = limits
        self._problems: list[str | EntryProblem] = []
        self._nodes = 0
        self._calling: list[str] = []

    def read(self, text: str) -> MissionDocument:
        """Return the document. Raise ConfigError with all problems."""
        try:
            table = read_toml(text)
        except TomlError as problem:
            raise ConfigError(f"the mission {problem}") from problem
        head = self._read_head(table)
        self._calling = [head.name] if head else []
        root = self._read_root(table, ())
        trial = table.get("trial", {})
        if not isinstance(trial, dict):
            self._problems.append(TOP.field("trial").problem("must be a table"))
        if self._nodes > NODES_MAX:
            text = f"has more than {NODES_MAX} steps, with those of the missions that it calls"
            self._problems.append(_ROOT.problem(text))
        if root is not None and not self._problems:
            self._check_limits(root)
        if head is None or root is None or self._problems:
            raise ConfigError(*self._problems)
        return MissionDocument(
            name=head.name,
            title=head.title or head.name,
            description=head.description,
            limits=self._limits,
            root=root,
            trial=trial,
        )

    def _read_head(self, table: Mapping[str, Any]) -> _Head | None:
        """Return the head, whose limits count from now on."""
        known = {name: value for name, value in table.items() if name not in ("limits", "mission", "trial")}
        head, limits = None, OwnLimits()
        try:
            head = parse(_Head, known)
            # An entry that a called mission leaves out is no limit, as in its `[limits]`.
            own = {"alone": head.alone, "pause": head.pause}
            self._tighten({name: own[name] for name in own if name in table or not self._is_called})
        except ConfigError as problem:
            self._problems += [_name_all(problem) for problem in problem.problems]
        try:
            limits = read_value(OwnLimits, table.get("limits", {}), TOP.field("limits"))
        except ConfigError as problem:
            self._problems += problem.problems
        self._tighten(asdict(limits))
        return head

    def _tighten(self, own: Mapping[str, float | None]) -> None:
        """Apply a document's limits; one that is looser than the robot's is a problem."""
        values = asdict(self._limits)
        for name, value in own.items():
            if value is None:
                continue
            entry = TOP.field(name) if name in ("alone", "pause") else TOP.field("limits").key(name)
            robot, unit = values[name], {"depth": "m", "battery": "V"}.get(name, "s")
            looser = value < robot if name == "battery" else value > robot
            if name == "unwatched":
                looser = robot > 0 and not 0 < value <= robot
            if looser and not self._is_called:
                where = "[missions] depth, [control] deepest" if name == "depth" else f"[missions] {name}"
                text = f"is {value:g} {unit}; robot.toml allows {robot:g} {unit} ({where})"
                self._problems.append(entry.problem(text))
            elif not looser and not (name == "unwatched" and value == 0):
                # 0: any time, which tightens nothing.
                values[name] = value
        self._limits = MissionLimits(**values)

    @property
    def _is_called(self) -> bool:
        return len(self._calling) > 1

    def _read_root(self, table: Mapping[str, Any], path: tuple[int, ...]) -> MissionStep | None:
        if "mission" not in table:
            self._problems.append(_ROOT.problem("is missing: the table of the first step"))
            return None
        return self._read_step(table["mission"], path, _ROOT, 1)

    def _read_step(
        self, table: Any, path: tuple[int, ...], where: DocumentEntry, level: int
    ) -> MissionStep | None:
        self._nodes += 1
        if self._nodes > NODES_MAX:
            return None
        if not isinstance(table, dict):
            self._problems.append(where.problem("must be a table"))
            return None
        do = table.get("do")
        cls = NODES.get(do) if isinstance(do, str) else None
        if cls is None:
            what = "is missing" if do is None else f"is {_short(do)}"
            known = ", ".join(NODES)
            self._problems.append(where.field("do").problem(f"{what}; it must be one of {known}"))
            return None
        rest = {name: value for name, value in table.items() if name not in ("do", "steps")}
        node: MissionNode | None = None
        try:
            node = parse(cls, rest, where)
        except ConfigError as problem:
            self._problems += problem.problems
        steps = self._read_steps(cls, table, path, where, level)
        if isinstance(node, CallBranch):
            steps = self._read_called(node.mission, path, where, level)
        if node is None or steps is None:
            return None
        step = MissionStep(path, node, steps)
        self._check_step(step, where)
        return step

    def _read_steps(
        self,
        cls: type[MissionNode],
        table: Mapping[str, Any],
        path: tuple[int, ...],
        where: DocumentEntry,
        level: int,
    ) -> tuple[MissionStep, ...] | None:
        """Return the steps below this one; None where they cannot be used."""
        if not issubclass(cls, Branch) or cls is CallBranch:
            if "steps" in table:
                self._problems.append(where.field("steps").problem(f"is not known here: {cls.do} has none"))
            return ()
        steps = table.get("steps", [])
        entry = where.field("steps")
        if not isinstance(steps, list):
            self._problems.append(entry.problem("must be a list of steps"))
            return None
        if level > LEVELS_MAX:
            self._problems.append(entry.problem(f"is deeper than {LEVELS_MAX} levels"))
            return None
        if len(steps) < cls.least or (cls.most is not None and len(steps) > cls.most):
            span = f"{cls.least}" if cls.most == cls.least else f"{cls.least} at least"
            self._problems.append(entry.problem(f"has {len(steps)}; {cls.do} needs {span}"))
            return None
        read = []
        for index, table in enumerate(steps):
            below = (*path, index + 1)
            name = f"step {'.'.join(map(str, below))}"
            read.append(self._read_step(table, below, DocumentEntry(name, (*entry.path, index)), level + 1))
            if self._nodes > NODES_MAX:
                return None
        valid = tuple(step for step in read if step is not None)
        return valid if len(valid) == len(steps) else None

    def _read_called(
        self, name: str, path: tuple[int, ...], where: DocumentEntry, level: int
    ) -> tuple[MissionStep, ...] | None:
        entry = where.field("mission")
        if name in self._calling:
            way = " → ".join([*self._calling, name])
            self._problems.append(entry.problem(f"is {name!r}, which would call itself: {way}"))
            return None
        if name not in self._library:
            known = ", ".join(sorted(self._library)) or "none"
            self._problems.append(entry.problem(f"is {_short(name)}; the library has {known}"))
            return None
        self._calling.append(name)
        before, self._problems = self._problems, []
        try:
            table = read_toml(self._library[name])
            self._read_head(table)
            step = None
            if "mission" in table:
                step = self._read_step(table["mission"], (*path, 1), DocumentEntry("mission"), level + 1)
            else:
                self._problems.append("it has no steps")
        except TomlError as problem:
            step = None
            self._problems.append(f"it {problem}")
        finally:
            self._calling.pop()
        before += [entry.problem(f"is {name!r}: {text}") for text in ConfigError(*self._problems).texts]
        self._problems = before
        return None if step is None else (MissionStep(step.path, step.node, step.steps, name),)

    def _check_step(self, step: MissionStep, where: DocumentEntry) -> None:
        match step.node:
            case AllBranch() | RaceBranch():
                self._check_claims(step, where)
            case WhileTrueBranch():
                count = sum(map(is_condition, step.steps))
                leading = sum(map(is_condition, step.steps[:count]))
                if not 0 < leading < len(step.steps):
                    self._problems.append(
                        where.sentence("needs leading conditions (is), and a step after them")
                    )
            case UntilBranch() if not is_condition(step.steps[0]):
                self._problems.append(where.sentence("its first step must be a condition (is)"))

    def _check_claims(self, step: MissionStep, where: DocumentEntry) -> None:
        claimed: dict[Claim, str] = {}
        for child in step.steps:
            for claim in sorted(child.steers):
                if claim in claimed:
                    both = f"steps {claimed[claim]} and {child.number}"
                    text = f"{both} would both steer the {claim}, side by side"
                    self._problems.append(where.sentence(text))
                claimed.setdefault(claim, child.number)

    def _check_limits(self, root: MissionStep) -> None:
        limits = self._limits
        self._problems += [entry.problem(text) for entry, text in _find_deep(root, limits.depth)]
        if root.longest > limits.time:
            text = (
                f"may take {root.longest:.0f} s, and limits.time is {limits.time:g} s; "
                "shorten its timeouts and repetitions"
            )
            self._problems.append(_ROOT.problem(text))
        self._check_unwatched(root)

    def _check_unwatched(self, root: MissionStep) -> None:
        """Check that a mission that begins on immersion may reach its end without a page."""
        waits = [step.node.longest for step in root.walk() if isinstance(step.node, WaitUntilWetLeaf)]
        dive, limit = root.longest - sum(waits), self._limits.unwatched
        if waits and 0 < limit < dive:
            text = (
                f"is {limit:g} s: that long after the last page it would come up, and once it is wet the "
                f"mission may take {ceil(dive)} s. "
                "Allow so much, here and in robot.toml ([missions] unwatched)"
            )
            self._problems.append(TOP.field("limits").key("unwatched").problem(text))


def _find_deep(step: MissionStep, limit: float, base: int = 0) -> Iterator[tuple[DocumentEntry, str]]:
    """Yield the entries of steps deeper than this (m), with the text; `base` is their mission's level.

    A problem of a called mission is a problem of the call, the only step of it in this document.
    """
    path = step.path[base:]
    name = f"step {'.'.join(map(str, path))}" if path else "mission"
    entry = DocumentEntry(name, _entry_path(path))
    if isinstance(step.node, Leaf) and step.node.deepest > limit:
        yield entry, f"goes to {step.node.deepest:g} m, and the depth is limited to {limit:g} m"
    for child in step.steps:
        if not child.called:
            yield from _find_deep(child, limit, base)
            continue
        for below, text in _find_deep(child, limit, len(child.path)):
            yield entry.field("mission"), f"is {child.called!r}: {below.problem(text).text}"


def is_condition(step: MissionStep) -> bool:
    """Return True for a step that only asks: `is`, or an `invert` of one."""
    if isinstance(step.node, InvertBranch):
        return is_condition(step.steps[0])
    return isinstance(step.node, IsLeaf)


def _entry_path(path: tuple[int, ...]) -> tuple[str | int, ...]:
    return ("mission", *(part for index in path for part in ("steps", index - 1)))


def _name_all(problem: EntryProblem) -> EntryProblem:
    """Return the problem with all known names: the tables of steps are read apart."""
    if "known are" not in problem.words:
        return problem
    known = ", ".join([field.name for field in fields(_Head)] + ["limits", "mission", "trial"])
    text = f"is not known here; known are {known}" if len(problem.path) == 1 else problem.words
    return EntryProblem(problem.path, problem.text.replace(problem.words, text), text)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}…"
