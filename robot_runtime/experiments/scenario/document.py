"""The scenario: a TOML document that describes an experiment completely, read strictly.

SI units; world axes north, east, down from the start, angles in rad. docs/use/scenarios.md has the table.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Any, Literal

from robot_runtime.config import ControlConfig
from robot_runtime.contract.commands import MissionCommand
from robot_runtime.contract.craft import Craft, complete_sensors
from robot_runtime.contract.hints import read_fields
from robot_runtime.contract.limits import VISION_RATE, ConfigError, Range
from robot_runtime.contract.missions import NO_LIMITS, MissionLimits
from robot_runtime.contract.parsing import TOP, parse, read_value
from robot_runtime.contract.problems import DocumentEntry, EntryProblem
from robot_runtime.contract.toml_text import TomlError, read_toml
from robot_runtime.contract.vision_settings import MarkerDictionary
from robot_runtime.control.controllers import check_controller
from robot_runtime.control.craft_gains import tune_to_craft
from robot_runtime.experiments.scenario.events import (
    Colour,
    CommandEvent,
    TimedEvent,
    WaterEvent,
    read_event,
)
from robot_runtime.missions.document import called_by, read_mission
from robot_runtime.missions.library import shipped_missions
from robot_runtime.simulation.boards.mistakes import check_mistake
from robot_runtime.simulation.water.parameters import SensorQuality, SimulationParameters, Vector
from robot_runtime.simulation.water.surroundings import (
    FLOATING,
    Basin,
    Current,
    StartPose,
    Trim,
    Waves,
    check_beacons,
    check_start,
)
from robot_runtime.simulation.water.world import World

MISSION_AT = 1.0
"""s at which the scenario's mission begins."""
DURATION = Range(1, 3600)
"""s."""
SEED = Range(0, 2**32 - 1)
EVENTS_MAX = 500
TARGETS_MAX = 16
NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,59}")
TITLE_MAX, DESCRIPTION_MAX = 100, 2000
FACTOR = 4.0
"""By which a number of the robot may be smaller or larger than the one it replaces: twice what is uncertain
about the assumed ones, and as far as steps of 5 ms remain stable."""
_LIMITS: dict[str, tuple[float, float]] = {
    "temperature": (0.0, 40.0),
    "latency": (0.0, 5.0),
}
DEFAULT_CRAFT = Craft()
_OF_A_CRAFT = frozenset(field.name for field in fields(Craft))
"""Numbers whose limits are the craft's own."""
_ELSEWHERE = {"floor": "[scene] depth", "beacons": "[scene] beacons"}


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetBall:
    """A coloured ball that the camera can see; position in m north, east, down, size in m across."""

    colour: Colour
    position: Vector
    size: Annotated[float, Range(0.02, 2)] = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """The surroundings: a pool with walls, or natural water without; lengths in m."""

    kind: Literal["pool", "natural"]
    depth: float
    length: float | None = None
    width: float | None = None
    turbidity: Annotated[float, Range(0, 1)] = 0.1
    """0: clear, 1: nothing is seen beyond a hand's breadth."""
    targets: list[TargetBall] = field(default_factory=list)
    beacons: tuple[Vector, ...] = ()

    def __post_init__(self) -> None:
        if (self.kind == "pool") != (self.length is not None):
            raise ValueError("a pool has length and width, natural water neither")
        if len(self.targets) > TARGETS_MAX:
            raise ValueError(f"{len(self.targets)} targets; there can be at most {TARGETS_MAX}")
        check_beacons(self.beacons)
        _ = self.basin

    @property
    def basin(self) -> Basin:
        """The floor and walls."""
        return Basin(self.depth, self.length, self.width)


@dataclass(frozen=True, slots=True, kw_only=True)
class WaterMotion:
    """Current and waves at the start."""

    current: Current = field(default_factory=Current)
    waves: Waves = field(default_factory=Waves)


@dataclass(frozen=True, slots=True, kw_only=True)
class VisionChoice:
    """The camera of the vision node: drawn water with cards, or the rendered scene; rate in Hz.

    With `film` it is filmed in simulated time; on the robot the choice of its sessions is in force.
    """

    camera: Literal["card", "scene"] = "card"
    rate: Annotated[float, VISION_RATE] = 4.0
    colour: Colour = "yellow"
    markers: MarkerDictionary = "none"
    film: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """One experiment. `trim` is None where the hull's parameters say it; events are in order of time.

    `craft` says whose numbers hull and model-based controller have where `robot` and `control` leave them
    out: those of the default craft, or of the craft that the robot's configuration names.
    """

    name: str
    title: str
    description: str = ""
    duration: Annotated[float, DURATION]
    seed: Annotated[int, SEED] = 1
    scene: Scene
    start: StartPose = FLOATING
    water: WaterMotion = WaterMotion()
    trim: Trim | None = None
    craft: Literal["default", "robot"] = "default"
    robot: SimulationParameters = field(default_factory=SimulationParameters)
    mistakes: tuple[str, ...] = ()
    """Of the board; see `simulation/boards/mistakes.py`."""
    control: ControlConfig = field(default_factory=ControlConfig)
    vision: VisionChoice = VisionChoice()
    missions: MissionLimits = NO_LIMITS
    """What no mission may exceed, as in robot.toml."""
    mission: str = ""
    """The name of a mission of the library, which begins at `MISSION_AT`."""
    events: tuple[TimedEvent, ...] = ()

    def __post_init__(self) -> None:
        problems = [*self._texts(), *self._water(), *self._mistakes(), *self._events()]
        if problems:
            raise ConfigError(*problems)

    def _texts(self) -> list[EntryProblem]:
        problems = []
        if not NAME.fullmatch(self.name):
            text = f"is {self.name!r}; it is 1 to 60 small letters, digits, - and _, as it names a file"
            problems.append(TOP.field("name").problem(text))
        if not 1 <= len(self.title.strip()) <= TITLE_MAX:
            problems.append(TOP.field("title").problem(f"must be a text of 1 to {TITLE_MAX} characters"))
        if len(self.description) > DESCRIPTION_MAX:
            problems.append(TOP.field("description").problem(f"has more than {DESCRIPTION_MAX} characters"))
        return problems

    def _water(self) -> list[str | EntryProblem]:
        world = World(self.robot)
        world.set_basin(self.scene.basin)
        problems: list[str | EntryProblem] = []
        waves = [("water: waves", self.water.waves)]
        waves += [
            (f"event at {event.at:g} s", event.change)
            for event in self.events
            if isinstance(event, WaterEvent) and isinstance(event.change, Waves)
        ]
        for where, wave in waves:
            try:
                world.set_waves(wave)
            except ValueError as problem:
                problems.append(f"{where}: {problem}")
        try:
            check_start(self.start, self.scene.basin, self.robot.size)
        except ValueError as problem:
            problems.append(TOP.field("start").sentence(str(problem)))
        try:
            check_controller("depth", self.control.controller, self.control.gains)
        except ValueError as problem:
            problems.append(TOP.field("control").sentence(str(problem)))
        return problems

    def _mistakes(self) -> list[EntryProblem]:
        problems = []
        for index, text in enumerate(self.mistakes):
            try:
                check_mistake(text)
            except ValueError as problem:
                problems.append(TOP.field("mistakes").item(index).sentence(str(problem)))
        return problems

    def _events(self) -> list[str]:
        return [
            f"event {event.do} at {event.at:g} s comes after the end; the scenario lasts {self.duration:g} s"
            for event in self.events
            if event.at > self.duration
        ]


ROBOT = TOP.field("robot")
_STAND_IN: dict[str, Any] = {
    "name": "scenario",
    "title": "Scenario",
    "duration": DURATION.maximum,
    "scene": Scene(kind="natural", depth=1000.0),
}
"""Defaults for missing required entries, so that the rest can still be checked."""


def read_scenario(
    text: str, craft: Craft = DEFAULT_CRAFT, missions: Mapping[str, str] | None = None
) -> Scenario:
    """Return the scenario in a TOML text, on this robot's craft. Raise ConfigError with all problems.

    `missions` are the texts of the library's, by name; without it, those that ship with the program.
    """
    try:
        table = read_toml(text)
    except TomlError as problem:
        raise ConfigError(f"the scenario {problem}") from problem
    return read_scenario_table(table, craft, missions)


def read_scenario_table(
    table: dict[str, Any], craft: Craft = DEFAULT_CRAFT, missions: Mapping[str, str] | None = None
) -> Scenario:
    """Return the scenario in a table, as `read_scenario`."""
    problems: list[str | EntryProblem] = []
    own = craft if table.get("craft") == "robot" else DEFAULT_CRAFT
    values = {"robot": SimulationParameters.of(own)} | _read_entries(table, own, problems)
    try:
        scenario = Scenario(**(_STAND_IN | values))
    except ConfigError as problem:
        raise ConfigError(*problems, *problem.problems) from problem
    if scenario.mission:
        library = shipped_missions() if missions is None else missions
        problems += _check_mission(scenario, library)
    if problems:
        raise ConfigError(*problems)
    if scenario.mission:
        text = library[scenario.mission]
        command = MissionCommand(text=text, library=called_by(text, library))
        events = [*scenario.events, CommandEvent(at=MISSION_AT, command=command)]
        scenario = replace(scenario, events=tuple(sorted(events, key=lambda event: event.at)))
    return replace(scenario, control=tune_to_craft(scenario.control, own))


def _check_mission(scenario: Scenario, library: Mapping[str, str]) -> list[EntryProblem]:
    where = TOP.field("mission")
    if scenario.mission not in library:
        return [where.problem(f"is {scenario.mission!r}; the library has {', '.join(sorted(library))}")]
    try:
        read_mission(library[scenario.mission], library, scenario.missions)
    except ConfigError as problem:
        return [where.sentence(f"{scenario.mission}: {text}") for text in problem.texts]
    return []


def _read_entries(table: dict[str, Any], craft: Craft, problems: list[str | EntryProblem]) -> dict[str, Any]:
    """Return the valid entries of the table; add the problems of the others."""
    hints = read_fields(Scenario)
    values: dict[str, Any] = {}
    for name, value in table.items():
        try:
            if name not in hints:
                where = TOP.field(name, repr(name))
                problems.append(where.problem(f"is not known here; known are {', '.join(hints)}"))
            elif name == "events":
                values[name] = tuple(sorted(_read_events(value, problems), key=lambda event: event.at))
            elif name == "robot":
                values[name] = _read_robot(value, craft)
            else:
                values[name] = read_value(hints[name], value, TOP.field(name))
        except ConfigError as problem:
            problems += problem.problems
    problems += [TOP.field(name).problem("is missing") for name in _STAND_IN if name not in table]
    return values


def _read_events(tables: Any, problems: list[str | EntryProblem]) -> list[TimedEvent]:
    if not isinstance(tables, list):
        problems.append(TOP.field("events").problem("must be tables, each headed [[events]]"))
        return []
    if len(tables) > EVENTS_MAX:
        problems.append(f"{len(tables)} events; there can be at most {EVENTS_MAX}")
        return []
    events = []
    for index, table in enumerate(tables):
        try:
            events.append(read_event(table, DocumentEntry(f"event {index + 1}", ("events", index))))
        except ConfigError as problem:
            problems += problem.problems
    return events


def _read_robot(table: Any, craft: Craft) -> SimulationParameters:
    """Return the simulated robot with the scenario's changes. Raise ConfigError."""
    plain = SimulationParameters.of(craft)
    if not isinstance(table, dict):
        raise ConfigError(ROBOT.problem("must be a table"))
    problems = [
        ROBOT.field(name).problem(f"belongs to {there}")
        for name, there in _ELSEWHERE.items()
        if name in table
    ]
    given = {name: value for name, value in table.items() if name not in _ELSEWHERE}
    try:
        parsed = parse(SimulationParameters, complete_sensors(plain, given), ROBOT)
    except ConfigError as problem:
        raise ConfigError(*problems, *problem.problems) from problem
    default = SimulationParameters()
    values = {name: getattr(parsed, name) for name in given}
    for name, value in values.items():
        if name not in _OF_A_CRAFT or isinstance(value, SensorQuality):
            problems += _check_number(ROBOT.field(name), value, getattr(default, name))
    if problems:
        raise ConfigError(*problems)
    return replace(plain, **values)


def _check_number(where: DocumentEntry, value: Any, default: Any) -> list[EntryProblem]:
    """Return the problems of an overridden number, or of each in a tuple, that the physics cannot handle."""
    if isinstance(value, tuple):
        return [
            problem
            for index, (number, own) in enumerate(zip(value, default, strict=True))
            for problem in _check_number(where.item(index), number, own)
        ]
    if isinstance(value, SensorQuality):
        return _check_number(where.key("latency"), value.latency, 0.0) if value.latency else []
    if not isinstance(value, float):
        return []
    low, high = (
        _LIMITS.get(str(where.path[1]))
        or _LIMITS.get(str(where.path[-1]))
        or sorted((default / FACTOR, default * FACTOR))
    )
    if low <= value <= high:
        return []
    return [where.problem(f"is {value:g}; it must lie between {low:g} and {high:g}")]
