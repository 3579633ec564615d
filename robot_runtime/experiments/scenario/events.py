"""What can happen during a scenario: one dataclass for each `do`, with the arguments of the like-named
command of the runtime or question to the simulator."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from math import hypot
from typing import Annotated, Any, ClassVar, Literal

from robot_runtime.contract.documents import Steering
from robot_runtime.contract.limits import SET_POINT, VISION_RATE, ConfigError, Range
from robot_runtime.contract.parsing import parse, place
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.loop import SET_POINTS, LoopName
from robot_runtime.control.supervisor import ALONE_MAX
from robot_runtime.simulation.water.faults import Kind, SimulatedFault, check_sensor
from robot_runtime.simulation.water.parameters import Vector
from robot_runtime.simulation.water.surroundings import Current, Trim, Waves, check_beacons

Colour = Literal["red", "yellow", "green", "blue"]
Addressee = Literal["runtime", "simulator", "board", "session"]
LineKind = Literal["bit_errors", "drop", "double", "insert", "burst", "stall", "cut", "clean"]
TEXT_MAX = 200

_LINE_NUMBERS: dict[str, tuple[str, ...]] = {
    "burst": ("rate", "length"),
    "stall": ("seconds",),
    "cut": ("on",),
    "clean": (),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Event(ABC):
    """Something that happens at a time (s since the start)."""

    do: ClassVar[str]
    to: ClassVar[Addressee]

    at: Annotated[float, Range(0, 3600)]

    @property
    def question(self) -> dict[str, Any]:
        """The payload of the command or question; what was left out is not in it."""
        given = ((one.name, getattr(self, one.name)) for one in fields(self) if one.name != "at")
        return {name: value for name, value in given if value is not None}

    @property
    @abstractmethod
    def words(self) -> str:
        """What happens, in a few words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm(Event):
    """Arm the robot; it may go on without the server for `alone` s."""

    do = "arm"
    to = "runtime"

    alone: Annotated[float, Range(0, ALONE_MAX)] = 0.0

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        return "Arm"


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop(Event):
    """Disarm it."""

    do = "stop"
    to = "runtime"

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        return "STOP"


@dataclass(frozen=True, slots=True, kw_only=True)
class Acknowledge(Event):
    """Acknowledge the alarms, so that the robot may be armed again after a failsafe."""

    do = "acknowledge"
    to = "runtime"

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        return "Alarms acknowledged"


@dataclass(frozen=True, slots=True, kw_only=True)
class SetPoints(Event):
    """Wanted depths, m."""

    do = "set_points"
    to = "runtime"

    default: Annotated[float | None, SET_POINT] = None
    detected: Annotated[float | None, SET_POINT] = None

    def __post_init__(self) -> None:
        if self.default is None and self.detected is None:
            raise ValueError("set_points needs default, detected or both")

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        parts = [] if self.default is None else [f"set point {self.default:g} m"]
        parts += [] if self.detected is None else [f"{self.detected:g} m where the colour is seen"]
        words = ", ".join(parts)
        return words[0].upper() + words[1:]


@dataclass(frozen=True, slots=True, kw_only=True)
class ChooseController(Event):
    """Another controller, or other gains of it."""

    do = "controller"
    to = "runtime"

    name: str
    gains: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_controller("depth", self.name, {self.name: self.gains})

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        gains = ", ".join(f"{name} {value:g}" for name, value in self.gains.items())
        return f"Controller {self.name}" + (f": {gains}" if gains else "")


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeLoop(Event):
    """Steer heading, pitch or roll, or the depth, otherwise; set point in rad, the depth's in m."""

    do = "loop"
    to = "runtime"

    name: LoopName
    on: bool | None = None
    set_point: float | None = None
    controller: str | None = None
    gains: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.on is None and self.set_point is None and self.controller is None:
            raise ValueError("loop needs on, set_point or controller")
        span = SET_POINTS[self.name]
        if self.set_point is not None and not span.minimum <= self.set_point <= span.maximum:
            raise ValueError(f"set_point must lie between {span.minimum:.3g} and {span.maximum:.3g}")
        if self.gains and self.controller is None:
            raise ValueError("gains need the controller whose they are")
        if self.controller is not None:
            check_controller(self.name, self.controller, {self.controller: self.gains})

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        parts = [] if self.on is None else ["on" if self.on else "off"]
        parts += [] if self.set_point is None else [f"set point {self.set_point:g}"]
        parts += [] if self.controller is None else [self.controller]
        return f"{self.name.capitalize()}: {', '.join(parts)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Steer(Event):
    """Where it swims while it holds its depth."""

    do = "steering"
    to = "runtime"

    by: Steering

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        return "Swim towards the light" if self.by == "beacons" else "Stay"


@dataclass(frozen=True, slots=True, kw_only=True)
class Card(Event):
    """Hold a card before the camera; without a colour: take it away."""

    do = "card"
    to = "runtime"

    colour: Colour | None = None

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        return f"{self.colour.capitalize()} card" if self.colour else "Card away"


@dataclass(frozen=True, slots=True, kw_only=True)
class Look(Event):
    """How often the camera looks (Hz), and for which colour."""

    do = "vision"
    to = "runtime"

    rate: Annotated[float | None, VISION_RATE] = None
    colour: Colour | None = None

    def __post_init__(self) -> None:
        if self.rate is None and self.colour is None:
            raise ValueError("vision needs rate, colour or both")

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        parts = [] if self.rate is None else [f"at {self.rate:g} Hz"]
        parts += [] if self.colour is None else [f"for {self.colour}"]
        return f"Look {' '.join(parts)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Beacons(Event):
    """Light beacons at these places (m north, east, down) and nowhere else."""

    do = "beacons"
    to = "simulator"

    positions: tuple[Vector, ...]

    def __post_init__(self) -> None:
        check_beacons(self.positions)

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        count = len(self.positions)
        return (
            "No light beacon" if not count else "A light beacon" if count == 1 else f"{count} light beacons"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentChange(Event):
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
        """What happens, in a few words."""
        speed = hypot(self.north, self.east, self.down)
        return f"Current of {speed:.2g} m/s" if speed else "No current"


@dataclass(frozen=True, slots=True, kw_only=True)
class WavesChange(Event):
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
        """What happens, in a few words."""
        return f"Waves of ±{100 * self.amplitude:g} cm" if self.amplitude else "No waves"


@dataclass(frozen=True, slots=True, kw_only=True)
class TrimChange(Event):
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
        """What happens, in a few words."""
        return f"Trim: buoyancy {self.buoyancy:g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorFault(Event):
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
        """What happens, in a few words."""
        return (
            f"{self.sensor.replace('_', ' ').capitalize()}: {'mended' if self.kind == 'none' else self.kind}"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Line(Event):
    """Disturb the serial line in one direction, as the emulated board's `line`."""

    do = "line"
    to = "board"

    direction: Literal["to_board", "from_board"]
    kind: LineKind
    rate: Annotated[float | None, Range(0, 1)] = None
    """Of bits (bit_errors, burst) or characters (drop, double, insert) that this befalls."""
    length: Annotated[int | None, Range(1, 10_000)] = None
    """Bit times that a burst lasts."""
    seconds: Annotated[float | None, Range(0, 3600)] = None
    """That a stall lasts; 0 ends it."""
    on: bool | None = None
    """Whether the wire is cut."""

    def __post_init__(self) -> None:
        wanted = _LINE_NUMBERS.get(self.kind, ("rate",))
        for name in ("rate", "length", "seconds", "on"):
            if (getattr(self, name) is not None) != (name in wanted):
                raise ValueError(f"a line's {self.kind} takes {' and '.join(wanted) or 'nothing more'}")

    @property
    def words(self) -> str:
        """What happens, in a few words."""
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
class Mark(Event):
    """Point this moment out in the session."""

    do = "marker"
    to = "session"

    text: str

    def __post_init__(self) -> None:
        if not 1 <= len(self.text.strip()) <= TEXT_MAX:
            raise ValueError(f"a marker's text has 1 to {TEXT_MAX} characters")

    @property
    def words(self) -> str:
        """What happens, in a few words."""
        return self.text


EVENTS: tuple[type[Event], ...] = (
    Arm,
    Stop,
    Acknowledge,
    SetPoints,
    ChooseController,
    ChangeLoop,
    Steer,
    Card,
    Look,
    Beacons,
    CurrentChange,
    WavesChange,
    TrimChange,
    SensorFault,
    Line,
    Mark,
)
_CLASSES = {event.do: event for event in EVENTS}


def read_event(table: Any, where: str) -> Event:
    """An event from its table. Raises ConfigError with all problems."""
    if not isinstance(table, Mapping):
        raise ConfigError(f"{where} must be a table")
    do = table.get("do")
    event = _CLASSES.get(do) if isinstance(do, str) else None
    if event is None:
        what = "is missing" if do is None else f"is {do!r}"
        raise ConfigError(f"{place(where, 'do')} {what}; it must be one of {', '.join(_CLASSES)}")
    return parse(event, {name: value for name, value in table.items() if name != "do"}, where)


def check_controller(loop: str, name: str, gains: Mapping[str, Mapping[str, float]]) -> None:
    """Raises ValueError where the loop has no such controller, or gains are unknown or out of range."""
    controllers = {one.name: one for one in CONTROLLERS[loop]}
    for wanted in (name, *gains):
        if wanted not in controllers:
            raise ValueError(f"there is no controller {wanted!r}; there are {', '.join(controllers)}")
    for tuned, numbers in gains.items():
        controllers[tuned].check(numbers)
