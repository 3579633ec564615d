"""Events of a scenario: commands to the robot, and changes of water, serial line and recording."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields, make_dataclass
from math import hypot
from typing import Annotated, Any, ClassVar, Literal, get_args

from robot_runtime.contract.commands import (
    COMMANDS,
    CardCommand,
    ControllerCommand,
    LoopCommand,
    RobotCommand,
    VisionCommand,
)
from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.parsing import parse, place
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.simulation.water.faults import Kind, SimulatedFault, check_sensor
from robot_runtime.simulation.water.parameters import Vector
from robot_runtime.simulation.water.surroundings import Current, Trim, Waves, check_beacons

Colour = Literal["red", "yellow", "green", "blue"]
Addressee = Literal["runtime", "simulator", "board", "session"]
LineKind = Literal["bit_errors", "drop", "double", "insert", "burst", "stall", "cut", "clean"]
TEXT_MAX = 200
AT = Range(0, 3600)
"""s since the start."""

_LINE_NUMBERS: dict[str, tuple[str, ...]] = {
    "burst": ("rate", "length"),
    "stall": ("seconds",),
    "cut": ("on",),
    "clean": (),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedEvent(ABC):
    """Something that happens at a time (s since the start)."""

    do: ClassVar[str]
    to: ClassVar[Addressee]

    at: Annotated[float, AT]

    @property
    def question(self) -> dict[str, Any]:
        """The payload of the command or question; what was left out is not in it."""
        given = ((one.name, getattr(self, one.name)) for one in fields(self) if one.name != "at")
        return {name: value for name, value in given if value is not None}

    @property
    @abstractmethod
    def words(self) -> str:
        """A short description of the event."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandEvent(TimedEvent):
    """A command to the robot; `do` is the command's name."""

    to = "runtime"

    command: RobotCommand

    @property
    def do(self) -> str:  # type: ignore[override]
        """The command's name."""
        return self.command.policy.name

    @property
    def words(self) -> str:
        """A short description of the event."""
        return self.command.words


@dataclass(frozen=True, slots=True, kw_only=True)
class Beacons(TimedEvent):
    """Light beacons at these places (m north, east, down) and nowhere else."""

    do = "beacons"
    to = "simulator"

    positions: tuple[Vector, ...]

    def __post_init__(self) -> None:
        check_beacons(self.positions)

    @property
    def words(self) -> str:
        """A short description of the event."""
        count = len(self.positions)
        return (
            "No light beacon" if not count else "A light beacon" if count == 1 else f"{count} light beacons"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentChange(TimedEvent):
    """Another current; m/s and rad/s."""

    do = "current"
    to = "simulator"

    north: float = 0.0
    east: float = 0.0
    down: float = 0.0
    turning: float = 0.0

    def __post_init__(self) -> None:
        Current(self.north, self.east, self.down, self.turning)

    @property
    def words(self) -> str:
        """A short description of the event."""
        speed = hypot(self.north, self.east, self.down)
        return f"Current of {speed:.2g} m/s" if speed else "No current"


@dataclass(frozen=True, slots=True, kw_only=True)
class WavesChange(TimedEvent):
    """Other waves; m, s and rad."""

    do = "waves"
    to = "simulator"

    amplitude: float
    period: float = 2.0
    direction: float = 0.0

    def __post_init__(self) -> None:
        Waves(self.amplitude, self.period, self.direction)

    @property
    def words(self) -> str:
        """A short description of the event."""
        return f"Waves of ±{100 * self.amplitude:g} cm" if self.amplitude else "No waves"


@dataclass(frozen=True, slots=True, kw_only=True)
class TrimChange(TimedEvent):
    """Another trim; share of the weight and m."""

    do = "trim"
    to = "simulator"

    buoyancy: float
    forward: float
    right: float
    above: float

    def __post_init__(self) -> None:
        Trim(self.buoyancy, self.forward, self.right, self.above)

    @property
    def words(self) -> str:
        """A short description of the event."""
        return f"Trim: buoyancy {self.buoyancy:g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorFaultChange(TimedEvent):
    """Break a sensor, or mend it."""

    do = "fault"
    to = "simulator"

    sensor: str
    kind: Kind
    share: float | None = None
    size: float | None = None
    speed: float | None = None

    def __post_init__(self) -> None:
        check_sensor(
            self.sensor, SimulatedFault(kind=self.kind, share=self.share, size=self.size, speed=self.speed)
        )

    @property
    def words(self) -> str:
        """A short description of the event."""
        return (
            f"{self.sensor.replace('_', ' ').capitalize()}: {'mended' if self.kind == 'none' else self.kind}"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LineFaultChange(TimedEvent):
    """Disturb the serial line in one direction, as the emulated board's `line`."""

    do = "line"
    to = "board"

    direction: Literal["to_board", "from_board"]
    kind: LineKind
    rate: Annotated[float | None, Range(0, 1)] = None
    """Probability for each bit (bit_errors, burst) or character (drop, double, insert)."""
    length: Annotated[int | None, Range(1, 10_000)] = None
    """Length of a burst in bit times."""
    seconds: Annotated[float | None, Range(0, 3600)] = None
    """Duration of a stall; 0 ends it."""
    on: bool | None = None
    """True to cut the wire."""

    def __post_init__(self) -> None:
        allowed = _LINE_NUMBERS.get(self.kind, ("rate",))
        for name in ("rate", "length", "seconds", "on"):
            if (getattr(self, name) is not None) != (name in allowed):
                raise ValueError(f"a line's {self.kind} takes {' and '.join(allowed) or 'nothing more'}")

    @property
    def words(self) -> str:
        """A short description of the event."""
        way = "Line to the board" if self.direction == "to_board" else "Line from the board"
        if self.kind == "cut":
            return f"{way} {'cut' if self.on else 'whole again'}"
        return f"{way}: {self.kind.replace('_', ' ')}"

    @property
    def command(self) -> str:
        """The command to the emulated board's socket."""
        given = [one for one in (self.rate, self.length, self.seconds) if one is not None]
        if self.on is not None:
            return f"line {self.direction} cut {'on' if self.on else 'off'}"
        return " ".join([f"line {self.direction} {self.kind}", *(f"{one:g}" for one in given)])


@dataclass(frozen=True, slots=True, kw_only=True)
class BookmarkEvent(TimedEvent):
    """Point this moment out in the session."""

    do = "marker"
    to = "session"

    text: str

    def __post_init__(self) -> None:
        if not 1 <= len(self.text.strip()) <= TEXT_MAX:
            raise ValueError(f"a marker's text has 1 to {TEXT_MAX} characters")

    @property
    def words(self) -> str:
        """A short description of the event."""
        return self.text


EVENTS: dict[str, type[TimedEvent]] = {
    event.do: event
    for event in (
        Beacons,
        CurrentChange,
        WavesChange,
        TrimChange,
        SensorFaultChange,
        LineFaultChange,
        BookmarkEvent,
    )
}
"""Of the water, the line and the recording; those of the robot are its commands."""


def event_names() -> list[str]:
    """Every `do` that a scenario may have."""
    return [*(name for name, cls in COMMANDS.items() if cls.policy.in_scenarios), *EVENTS]


def read_event(table: Any, where: str) -> TimedEvent:
    """An event from its table. Raises ConfigError with all problems."""
    if not isinstance(table, Mapping):
        raise ConfigError(f"{where} must be a table")
    do = table.get("do")
    if do not in (names := event_names()):
        what = "is missing" if do is None else f"is {do!r}"
        raise ConfigError(f"{place(where, 'do')} {what}; it must be one of {', '.join(names)}")
    rest = {name: value for name, value in table.items() if name != "do"}
    if do in EVENTS:
        return parse(EVENTS[do], rest, where)
    cls = COMMANDS[do]
    timed: Any = parse(make_dataclass(do, [], bases=(cls, _Timed), frozen=True, kw_only=True), rest, where)
    command = cls(**{one.name: getattr(timed, one.name) for one in fields(cls)})
    _check_command(command, where)
    return CommandEvent(at=timed.at, command=command)


@dataclass(frozen=True, kw_only=True)
class _Timed:
    at: Annotated[float, AT]


def _check_command(command: RobotCommand, where: str) -> None:
    """Raises ConfigError where a scenario's robot could not perform it."""
    try:
        match command:
            case ControllerCommand(name=name, gains=gains):
                check_controller("depth", name, {name: gains})
            case LoopCommand(controller=None, gains=gains) if gains:
                raise ValueError("gains need the controller whose they are")
            case LoopCommand(name=loop, controller=str(name), gains=gains):
                check_controller(loop, name, {name: gains})
            case CardCommand(colour=str(colour)) | VisionCommand(colour=str(colour)):
                if colour not in get_args(Colour):
                    known = ", ".join(map(repr, get_args(Colour)))
                    raise ValueError(f"colour is {colour!r}; it must be one of {known}")
    except ValueError as problem:
        raise ConfigError(place(where, str(problem))) from problem


def check_controller(loop: str, name: str, gains: Mapping[str, Mapping[str, float]]) -> None:
    """Raises ValueError where the loop has no such controller, or gains are unknown or out of range."""
    controllers = {one.name: one for one in CONTROLLERS[loop]}
    for required in (name, *gains):
        if required not in controllers:
            raise ValueError(f"there is no controller {required!r}; there are {', '.join(controllers)}")
    for tuned, numbers in gains.items():
        controllers[tuned].check(numbers)
