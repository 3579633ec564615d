"""Records and documents of the runtime, beside the board's own packets; SI units.

Records have a byte layout, for numbers that come fast. Documents are JSON objects, for what is rare or has
no fixed size. Both are frozen dataclasses; the page's types are generated from them.
"""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from robot_runtime.contract.calibration import CalibrationValues
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.missions import MissionPhase, MissionStatus
from robot_runtime.contract.packets.layout import Record, Wire, record
from robot_runtime.contract.vision_settings import VisionSettings


@record()
class Control(Record):
    """One tick of the control node."""

    set_point: Annotated[float, Wire("f", unit="m", meaning="depth set point")]
    depth: Annotated[float, Wire("f", unit="m", meaning="depth that the controller used")]
    error: Annotated[float, Wire("f", unit="m", meaning="set point minus depth")]
    output: Annotated[float, Wire("f", meaning="vertical command, -1 to 1, downwards")]
    latency: Annotated[float, Wire("f", unit="s", meaning="age of the depth when it was used")]


_TURNS = "heading, pitch, roll"


@record()
class Turning(Record):
    """One tick of the control node, for the angles; positive: to the right, nose up, right side down."""

    set_point: Annotated[
        tuple[float, float, float],
        Wire("f", unit="rad", count=3, meaning=f"set points of {_TURNS}; NaN while not controlled"),
    ]
    measured: Annotated[tuple[float, float, float], Wire("f", unit="rad", count=3, meaning=_TURNS)]
    output: Annotated[
        tuple[float, float, float],
        Wire("f", count=3, meaning="commands yaw, pitch, roll, -1 to 1; NaN while not controlled"),
    ]


@record()
class Track(Record):
    """The way since the robot was armed, by dead reckoning: an estimate whose error grows, not a position."""

    x: Annotated[float, Wire("f", unit="m", meaning="along heading 0")]
    y: Annotated[float, Wire("f", unit="m", meaning="along heading 90°")]
    deviation_x: Annotated[float, Wire("f", unit="m", meaning="standard deviation of x")]
    deviation_y: Annotated[float, Wire("f", unit="m", meaning="standard deviation of y")]


@record()
class Truth(Record):
    """The true motion of the simulated body; north, east, down and forward, right, down."""

    position: Annotated[tuple[float, float, float], Wire("f", unit="m", count=3, meaning="north, east, down")]
    attitude: Annotated[
        tuple[float, float, float, float],
        Wire("f", count=4, meaning="unit quaternion w, x, y, z, body to world"),
    ]
    velocity: Annotated[tuple[float, float, float], Wire("f", unit="m/s", count=3, meaning="in body axes")]
    rate: Annotated[tuple[float, float, float], Wire("f", unit="rad/s", count=3, meaning="in body axes")]
    fins: Annotated[tuple[float, float, float, float], Wire("f", unit="rad", count=4, meaning="fin angles")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Document:
    """Base of everything that travels as a JSON object; `time` is the steady clock's, in s."""

    time: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DebugLine(Document):
    """An event of the board in words, or a line of text of its sketch; level as in DebugLevel."""

    level: int
    text: str


Severity = Literal["info", "caution", "alarm"]
MISSION_MARK = "mission_mark"
"""Kind of the event with which a mission marks the session."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Event(Document):
    """Something that happened, in words for a person; `kind` is one word for programs."""

    kind: str
    severity: Severity
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A rectangle in the picture; each number a share of the picture's width or height."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A patch of the target colour, with its measures; `refused` says why it does not count."""

    box: Box
    area: float = field(metadata={"meaning": "share of the picture"})
    fill: float = field(metadata={"meaning": "area over that of its box"})
    aspect: float = field(metadata={"meaning": "the box's width over its height"})
    circularity: float = field(metadata={"meaning": "4π area over perimeter²"})
    refused: str = field(metadata={"meaning": "in words; empty where it counts"})


@dataclass(frozen=True, slots=True, kw_only=True)
class ArucoMarker:
    """An ArUco marker in the picture."""

    number: int
    corners: list[float] = field(
        metadata={"meaning": "x and y of its four corners, clockwise, as shares of width and height"}
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Detection(Document):
    """The result of searching one picture: the largest patch of the colour that was found."""

    taken: float
    colour: str | None
    box: Box | None
    area: float
    processing: float
    candidates: list[Candidate] = field(default_factory=list)
    markers: list[ArucoMarker] = field(default_factory=list)
    confirmed: list[str] = field(
        default_factory=list,
        metadata={"meaning": "colours and markers that enough of the last pictures show"},
    )
    target: str | None = field(
        default=None,
        metadata={"meaning": "what sets the set point: the confirmed target colour, or name of an action"},
    )
    set_point: float | None = field(
        default=None,
        metadata={"meaning": "m; the action for the target; null: the detected set point"},
    )
    latency: float | None = field(
        default=None,
        metadata={"meaning": "s; age of the last picture when the control node first used it"},
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class VisionInForce(Document):
    """The vision settings in force; sent at every change and every ten seconds."""

    settings: VisionSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationKept(Document):
    """The calibration that the board stores; sent at every change and every ten seconds."""

    values: CalibrationValues | None = field(metadata={"meaning": "null until the board has told it"})
    missing: list[str] = field(metadata={"meaning": "the steps that are not done, in words"})


@dataclass(frozen=True, slots=True, kw_only=True)
class SwimmingCraft(Document):
    """The craft that the simulator swims; sent at its start, at every change and every ten seconds."""

    title: str = field(metadata={"meaning": "of its file; says if a number was changed since"})
    origin: str = field(metadata={"meaning": "where its numbers come from"})
    craft: Craft = field(metadata={"meaning": "all its numbers, with the trim as it is now"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Gain:
    """One number of a controller that may be tuned."""

    name: str
    value: float
    minimum: float
    maximum: float
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerChoice:
    """A controller that can be chosen, and its gains as they stand."""

    name: str
    title: str
    gains: list[Gain]


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """A control loop: depth (m), heading, pitch or roll (rad)."""

    name: str
    on: bool = field(metadata={"meaning": "whether it is controlled; in automatic the depth always is"})
    set_point: float
    controller: str
    controllers: list[ControllerChoice]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """The period, s, at which the board sends a topic at this baud rate."""

    topic: str
    period: float


ParameterType = Literal["number", "whole", "choice", "switch"]
ParameterValue = int | float | str | bool
Where = Literal["runtime", "firmware"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TunableParameter:
    """Something that may be tuned while the robot runs, and its value."""

    name: str
    type: ParameterType
    value: ParameterValue
    default: ParameterValue = field(metadata={"meaning": "its value when the runtime started"})
    minimum: float | None = field(metadata={"meaning": "of numbers"})
    maximum: float | None
    unit: str
    meaning: str
    choices: list[str] = field(metadata={"meaning": "empty but for a choice"})
    where: Where
    while_armed: bool = field(metadata={"meaning": "whether it may change while the robot is armed"})
    pending: bool = field(metadata={"meaning": "whether the board has not confirmed the value yet"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameters(Document):
    """Every parameter; sent at each change and every ten seconds."""

    parameters: list[TunableParameter]


Steering = Literal["none", "beacons"]
Mode = Literal["disarmed", "manual", "automatic", "test", "failsafe"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Alarm:
    """A fault that is active, or not acknowledged yet."""

    fault: str = field(metadata={"meaning": "one word for programs, as in docs/reference/faults.md"})
    severity: Severity
    since: float = field(metadata={"meaning": "s, steady clock"})
    until: float | None = field(metadata={"meaning": "s, steady clock; seen last then; null while active"})
    active: bool = field(metadata={"meaning": "whether the fault is still there"})
    acknowledged: bool
    what: str
    cause: str = field(metadata={"meaning": "the likely one"})
    remedy: str = field(metadata={"meaning": "what to do"})
    consequences: list[str] = field(metadata={"meaning": "faults that follow from this one"})


@dataclass(frozen=True, slots=True, kw_only=True)
class State(Document):
    """The robot as a whole; sent once a second and at every change."""

    run: str = field(metadata={"meaning": "16 hexadecimal digits, new at every start of the runtime"})
    mode: Mode
    armed: bool
    armed_since: float | None
    alarms: list[Alarm]
    refusals: list[str] = field(metadata={"meaning": "reasons against arming; empty if it is possible"})
    connected: bool
    connection: str = field(metadata={"meaning": "state of the serial link, as a sentence"})
    port: str
    baud: int
    paces: list[Pace]
    epoch: int | None
    set_point_default: float
    set_point_detected: float
    unwatched: float = field(
        default=0.0,
        metadata={
            "meaning": "s after which the armed robot is stopped if nobody watches, of this or the next "
            "arming; 0: never, or by a mission's own limit"
        },
    )
    deepest: float = field(default=10.0, metadata={"meaning": "m; no set point lies below"})
    battery_left: float | None = field(
        default=None,
        metadata={
            "meaning": "s until the low-battery alarm, estimated as if all fins swam at the most; null: "
            "capacity or voltage not known"
        },
    )
    buoyancy_known: bool = field(
        default=True, metadata={"meaning": "false: nobody has said by how much this robot floats"}
    )
    steering: Steering = field(default="none", metadata={"meaning": "course while the robot holds its depth"})
    control_rate: float
    profile: Literal["full", "lean"] = field(
        default="full",
        metadata={"meaning": "lean: smaller and fewer pictures, for a slow computer"},
    )
    vision_rate: float
    vision_colour: str
    colours: list[str]
    card: str | None
    cards: list[str] = field(
        default_factory=list, metadata={"meaning": "cards that can be shown to the camera; empty if none can"}
    )
    camera: str
    stream_rate: float = field(default=15.0, metadata={"meaning": "Hz; of the camera's stream, at most"})
    loops: list[Loop] = field(default_factory=list)
    pilot_dropped: int = field(
        default=0,
        metadata={"meaning": "pilot inputs dropped since the start: too old, damaged, or of another lease"},
    )


ExperimentKind = Literal["step", "relay"]
ExperimentPhase = Literal["settling", "balancing", "running", "complete", "stopped", "failed"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment(Document):
    """The progress of an experiment on a loop; sent at every change, twice a second, and once at its end."""

    number: int = field(metadata={"meaning": "given by the command that began it"})
    kind: ExperimentKind
    loop: str
    phase: ExperimentPhase
    since: float = field(metadata={"meaning": "s, steady clock; when this phase began"})
    progress: float = field(metadata={"meaning": "share that is done, 0 to 1"})
    cycles: int = field(metadata={"meaning": "of the relay, measured so far"})
    bias: float = field(metadata={"meaning": "of the relay: the mean command that balances the load"})
    text: str = field(metadata={"meaning": "reason of its end; empty after a normal one"})


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionStepState:
    """A step of a running mission."""

    path: str = field(metadata={"meaning": 'from 1 along the branches, as "3.1.2"; empty for the first step'})
    do: str
    words: str = field(metadata={"meaning": "the step in a few words"})
    note: str = field(metadata={"meaning": "its author's remark"})
    status: MissionStatus
    elapsed: float = field(metadata={"meaning": "s of the mission's clock since it began, or that it took"})
    longest: float = field(metadata={"meaning": "s that it takes at most"})
    rounds: int = field(metadata={"meaning": "of a repetition: how often it is done"})
    text: str = field(metadata={"meaning": "why it failed; empty where it did not"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Mission(Document):
    """A mission as it stands: sent at its start, at each change, once a second, and at its end.

    Each states everything but `document`, which only the first and the last one have.
    """

    number: int = field(metadata={"meaning": "of the mission, from 1 since the runtime started"})
    sequence: int = field(metadata={"meaning": "of this document in the mission, from 0"})
    name: str
    title: str
    phase: MissionPhase
    text: str = field(metadata={"meaning": "why it is paused, or how it ended"})
    elapsed: float = field(metadata={"meaning": "s of the mission's clock"})
    remaining: float = field(metadata={"meaning": "s that it takes at most from now on"})
    progress: float = field(metadata={"meaning": "share that is done, 0 to 1"})
    paused: float = field(metadata={"meaning": "s that it has been paused in all"})
    pause: float = field(metadata={"meaning": "s that it may be paused in all"})
    deepest: float = field(metadata={"meaning": "m; the greatest depth so far"})
    steps: list[MissionStepState]
    document: str = field(
        default="", metadata={"meaning": "the mission's TOML; in its first and last document"}
    )
    surfaced: float | None = field(
        default=None,
        metadata={
            "meaning": "s, steady clock, at which it was at the surface after its end: the last document "
            "comes once more with it. null before, and where it did not dive"
        },
    )
