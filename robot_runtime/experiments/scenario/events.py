"""Events of a scenario: commands to the robot, and changes of water, serial line and recording."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, make_dataclass
from functools import cache
from math import hypot
from typing import Annotated, Any, ClassVar, Literal, get_args

from robot_runtime.contract.card_colours import MARKER_CARD
from robot_runtime.contract.commands import (
    COMMANDS,
    CardCommand,
    ControllerCommand,
    LoopCommand,
    RobotCommand,
    VisionCommand,
)
from robot_runtime.contract.declarations import Declarations
from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.contract.vision_settings import marker_name
from robot_runtime.control.controllers import check_controller
from robot_runtime.simulation.water.faults import SimulatedFault, check_sensor
from robot_runtime.simulation.water.requests import BeaconPositions, SensorFaultRequest
from robot_runtime.simulation.water.surroundings import Current, Trim, Waves, check_beacons

Colour = Literal["red", "yellow", "green", "blue"]
WaterChange = BeaconPositions | Current | Waves | Trim | SensorFaultRequest
WATER_CHANGES: dict[str, type[WaterChange]] = {
    "beacons": BeaconPositions,
    "current": Current,
    "waves": Waves,
    "trim": Trim,
    "fault": SensorFaultRequest,
}
"""By the name of the simulator's request."""
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
    """An event at a time (s since the start)."""

    do: ClassVar[str]

    at: Annotated[float, AT]

    @property
    @abstractmethod
    def label(self) -> str:
        """A short description of the event."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandEvent(TimedEvent):
    """A command to the robot; `do` is the command's name."""

    command: RobotCommand

    @property
    def do(self) -> str:  # type: ignore[override]
        """The command's name."""
        return self.command.policy.name

    @property
    def label(self) -> str:
        """A short description of the event."""
        return self.command.label


@dataclass(frozen=True, slots=True, kw_only=True)
class WaterEvent(TimedEvent):
    """A change of the water, of the hull's trim or of a sensor; `do` names the simulator's request."""

    change: WaterChange

    @property
    def do(self) -> str:  # type: ignore[override]
        """The name of the request."""
        return next(name for name, cls in WATER_CHANGES.items() if isinstance(self.change, cls))

    @property
    def question(self) -> dict[str, Any]:
        """The payload of the request, without what was left out."""
        return {name: value for name, value in asdict(self.change).items() if value is not None}

    @property
    def label(self) -> str:
        """A short description of the event."""
        match self.change:
            case BeaconPositions(positions=places):
                count = len(places)
                return (
                    f"{count} light beacons"
                    if count > 1
                    else "A light beacon"
                    if count
                    else "No light beacon"
                )
            case Current(north=north, east=east, down=down):
                speed = hypot(north, east, down)
                return f"Current of {speed:.2g} m/s" if speed else "No current"
            case Waves(amplitude=amplitude):
                return f"Waves of ±{100 * amplitude:g} cm" if amplitude else "No waves"
            case Trim(buoyancy=buoyancy):
                return f"Trim: buoyancy {buoyancy:g}"
            case SensorFaultRequest(sensor=sensor, kind=kind):
                return f"{sensor.replace('_', ' ').capitalize()}: {'mended' if kind == 'none' else kind}"


@dataclass(frozen=True, slots=True, kw_only=True)
class LineFaultChange(TimedEvent):
    """A fault of the serial line in one direction.

    It is as the emulated board's `line`.
    """

    do = "line"

    direction: Literal["to_board", "from_board"]
    kind: LineKind
    rate: Annotated[float | None, Range(0, 1)] = field(
        default=None,
        metadata={
            "description": "probability for each bit (bit_errors, burst) or character (drop, double, insert)"
        },
    )
    length: Annotated[int | None, Range(1, 10_000)] = field(
        default=None, metadata={"description": "of a burst, in bit times"}
    )
    seconds: Annotated[float | None, Range(0, 3600)] = field(
        default=None, metadata={"description": "of a stall; 0 ends it"}
    )
    on: bool | None = field(default=None, metadata={"description": "true cuts the wire"})

    def __post_init__(self) -> None:
        allowed = _LINE_NUMBERS.get(self.kind, ("rate",))
        for name in ("rate", "length", "seconds", "on"):
            if (getattr(self, name) is not None) != (name in allowed):
                raise ValueError(f"a line's {self.kind} takes {' and '.join(allowed) or 'nothing more'}")

    @property
    def label(self) -> str:
        """A short description of the event."""
        way = "Line to the board" if self.direction == "to_board" else "Line from the board"
        if self.kind == "cut":
            return f"{way} {'cut' if self.on else 'whole again'}"
        return f"{way}: {self.kind.replace('_', ' ')}"

    @property
    def command(self) -> str:
        """The command to the emulated board's socket."""
        given = [value for value in (self.rate, self.length, self.seconds) if value is not None]
        if self.on is not None:
            return f"line {self.direction} cut {'on' if self.on else 'off'}"
        return " ".join([f"line {self.direction} {self.kind}", *(f"{value:g}" for value in given)])


@dataclass(frozen=True, slots=True, kw_only=True)
class BookmarkEvent(TimedEvent):
    """A bookmark in the session."""

    do = "marker"

    text: str

    def __post_init__(self) -> None:
        if not 1 <= len(self.text.strip()) <= TEXT_MAX:
            raise ValueError(f"a marker's text has 1 to {TEXT_MAX} characters")

    @property
    def label(self) -> str:
        """A short description of the event."""
        return self.text


EVENTS: Declarations[str, Any] = Declarations("the name of a scenario's event")
"""Every `do` that a scenario may have: commands, changes of the water, events of line and recording."""
for _command in COMMANDS.values():
    if _command.policy.in_scenarios:
        EVENTS[_command.policy.name] = _command
for _name, _change in WATER_CHANGES.items():
    EVENTS[_name] = _change
EVENTS["line"] = LineFaultChange
EVENTS["marker"] = BookmarkEvent


def read_event(table: Any, where: DocumentEntry) -> TimedEvent:
    """Return an event from its table. Raise ConfigError with all problems."""
    if not isinstance(table, Mapping):
        raise ConfigError(where.problem("must be a table"))
    do = table.get("do")
    if not isinstance(do, str) or do not in EVENTS:
        what = "is missing" if do is None else f"is {do!r}"
        raise ConfigError(where.field("do").problem(f"{what}; it must be one of {', '.join(EVENTS)}"))
    rest = {name: value for name, value in table.items() if name != "do"}
    cls = EVENTS[do]
    if issubclass(cls, TimedEvent):
        event: TimedEvent = parse(cls, rest, where)
        return event
    if do == "waves" and "amplitude" not in table:
        raise ConfigError(where.field("amplitude").problem("is missing"))
    timed: Any = parse(_timed(cls), rest, where)
    content = cls(**{field.name: getattr(timed, field.name) for field in fields(cls)})
    _check(content, where)
    if isinstance(content, RobotCommand):
        return CommandEvent(at=timed.at, command=content)
    return WaterEvent(at=timed.at, change=content)


@dataclass(frozen=True, kw_only=True)
class _Timed:
    at: Annotated[float, AT]


@cache
def _timed(cls: type) -> Any:
    """Return the class of an event's entries: those of the change or command, and its time."""
    return make_dataclass(cls.__name__, [], bases=(cls, _Timed), frozen=True, kw_only=True)


def _check(content: RobotCommand | WaterChange, where: DocumentEntry) -> None:
    """Raise ConfigError where a scenario's robot or simulator cannot perform the command."""
    try:
        match content:
            case BeaconPositions(positions=positions):
                check_beacons(positions)
            case SensorFaultRequest(sensor=sensor, kind=kind, share=share, size=size, speed=speed):
                check_sensor(sensor, SimulatedFault(kind=kind, share=share, size=size, speed=speed))
            case ControllerCommand(name=name, gains=gains):
                check_controller("depth", name, {name: gains})
            case LoopCommand(controller=None, gains=gains) if gains:
                raise ValueError("gains need the name of their controller")
            case LoopCommand(name=loop, controller=str(name), gains=gains):
                check_controller(loop, name, {name: gains})
            case CardCommand(colour=str(colour)) if colour == marker_name(MARKER_CARD):
                pass
            case CardCommand(colour=str(colour)) | VisionCommand(colour=str(colour)):
                if colour not in get_args(Colour):
                    known = ", ".join(map(repr, get_args(Colour)))
                    raise ValueError(f"colour is {colour!r}; it must be one of {known}")
    except ValueError as problem:
        raise ConfigError(where.sentence(str(problem))) from problem
