"""The packets between Raspberry Pi and Arduino. `make generate` writes everything else from this file.

The first eight types keep the numbers of the thesis's Table 3. Body axes are forward, right, down; the world
is north, east, down, with north wherever the robot looked when the board started. Fin order: front right,
back right, back left, front left. A fin's angle is 0 where its tip lies along its mount (outwards and aft for
the front fins, outwards and forward for the back fins) and grows as the tip goes down.
"""

from collections.abc import Callable
from enum import IntEnum, IntFlag
from hashlib import sha256
from typing import Annotated, ClassVar, NamedTuple, TypeVar, dataclass_transform

from robot_runtime.contract.packets.chip_parameters import CHIP_PARAMETERS
from robot_runtime.contract.packets.layout import LayoutError, Record, Text, Wire, record

FIN_COUNT = 4
FRAME_BYTES_MAX = 64
"""Bytes of a whole frame on the line: its overhead, its messages and the closing zero."""

NOT_READY = 0x80
"""In ACKNOWLEDGE, beside the bits of what is held: the sender has no room for the next reliable frame."""

Micros = Annotated[int, Wire("I", unit="µs", meaning="the board's own clock, which wraps after 71 minutes")]
Fins = tuple[float, float, float, float]
Quaternion = tuple[float, float, float, float]


class DebugLevel(IntEnum):
    """The severity of a line of debug text."""

    DEBUG = 0
    INFO = 1
    WARNING = 2
    ERROR = 3


class StatusFlag(IntFlag):
    """Flags of the board's state, one bit each."""

    ARMED = 1
    HOST_ALIVE = 2
    NEUTRAL = 4
    MOTOR_POWER = 8
    BATTERY_LOW = 16
    DEFINITIONS_DIFFER = 32
    HIL = 64


class SensorFault(IntFlag):
    """Devices that did not answer, or answered nonsense, when last asked; one bit each."""

    IMU = 1
    PRESSURE = 2
    FIN_FRONT_RIGHT = 4
    FIN_BACK_RIGHT = 8
    FIN_BACK_LEFT = 16
    FIN_FRONT_LEFT = 32


class ResetCause(IntEnum):
    """Why the board started."""

    UNKNOWN = 0
    POWER_ON = 1
    EXTERNAL = 2
    BROWN_OUT = 3
    WATCHDOG = 4


ENUMERATIONS: tuple[type[IntEnum] | type[IntFlag], ...] = (DebugLevel, StatusFlag, SensorFault, ResetCause)


class TelemetryRate(NamedTuple):
    """Packets that the board sends by itself in ten slots of its schedule, or on a slow line in three."""

    in_ten: int
    in_three: int


class Packet(Record):
    """Base of everything on the line: a record with a type number.

    A reliable packet is repeated until it is acknowledged; of the others the next one is worth more.
    """

    __slots__ = ()
    type: ClassVar[int]
    reliable: ClassVar[bool]
    telemetry: ClassVar[TelemetryRate | None]


P = TypeVar("P", bound=Packet)
PACKETS: dict[int, type[Packet]] = {}


@dataclass_transform(frozen_default=True, kw_only_default=True)
def _packet(
    type_: int, *, reliable: bool = False, telemetry: TelemetryRate | None = None
) -> Callable[[type[P]], type[P]]:
    def register(cls: type[P]) -> type[P]:
        made = record()(cls)
        made.type = type_
        made.reliable = reliable
        made.telemetry = telemetry
        PACKETS[type_] = made
        return made

    return register


@_packet(0x00)
class Stop(Packet):
    """Host to board: disarm at once. Accepted always, from anybody, as often as it comes."""


@_packet(0x01, reliable=True)
class Start(Packet):
    """Host to board: arm. Refused unless the epoch is this boot's and valid traffic came for 500 ms."""

    epoch: Annotated[int, Wire("H", meaning="the boot that is meant, from the board's Hello; 0: none, void")]


@_packet(0x02)
class Navigation(Packet):
    """Host to board: the wanted force and torque, each as a share of the most. Expires after 500 ms."""

    x: Annotated[float, Wire("b", scale=1 / 127, meaning="forwards")]
    y: Annotated[float, Wire("b", scale=1 / 127, meaning="to the right")]
    z: Annotated[float, Wire("b", scale=1 / 127, meaning="downwards")]
    roll: Annotated[float, Wire("b", scale=1 / 127, meaning="right side down")]
    pitch: Annotated[float, Wire("b", scale=1 / 127, meaning="nose up")]
    yaw: Annotated[float, Wire("b", scale=1 / 127, meaning="to the right")]


@_packet(0x03, telemetry=TelemetryRate(10, 1))
class Imu(Packet):
    """Board to host, 100 Hz: attitude, turn rate and specific force, body axes forward, right, down."""

    time: Micros
    attitude: Annotated[
        Quaternion,
        Wire("h", scale=2**-14, count=4, meaning="unit quaternion w, x, y, z that turns body into world"),
    ]
    rate: Annotated[
        tuple[float, float, float],
        Wire("h", scale=0.00026632423, unit="rad/s", count=3, meaning="turn rate (65.5 counts per °/s)"),
    ]
    force: Annotated[
        tuple[float, float, float],
        Wire("h", scale=0.0011971008, unit="m/s²", count=3, meaning="specific force (8192 counts per g)"),
    ]


@_packet(0x04, telemetry=TelemetryRate(5, 3))
class Depth(Packet):
    """Board to host, 50 Hz: depth below the surface, from pressure."""

    time: Micros
    depth: Annotated[float, Wire("h", scale=0.001, unit="m", meaning="depth below the surface, downwards")]
    pressure: Annotated[int, Wire("I", unit="Pa", meaning="absolute pressure")]
    temperature: Annotated[float, Wire("h", scale=0.01, unit="°C", meaning="temperature of the water")]


@_packet(0x05, telemetry=TelemetryRate(1, 1))
class Beacon(Packet):
    """Board to host, 10 Hz: which light-beacon detectors hear their tone."""

    time: Micros
    right: Annotated[int, Wire("B", meaning="1 while the right detector sees the beacon")]
    left: Annotated[int, Wire("B", meaning="1 while the left detector sees the beacon")]


@_packet(0x06, telemetry=TelemetryRate(5, 1))
class Motor(Packet):
    """Board to host, 50 Hz: the four fins, wanted and measured, and what drives them."""

    time: Micros
    wanted: Annotated[Fins, Wire("h", scale=0.001, unit="rad", count=4, meaning="wanted fin angle")]
    angle: Annotated[Fins, Wire("h", scale=0.001, unit="rad", count=4, meaning="measured fin angle")]
    drive: Annotated[Fins, Wire("b", count=4, meaning="H-bridge command, -63 to 63")]


@_packet(0x09, reliable=True)
class Debug(Packet):
    """Board to host: a line of text."""

    time: Micros
    level: Annotated[int, Wire("B", meaning="see DebugLevel")]
    text: Annotated[str, Text(40)]


@_packet(0x0A)
class Hello(Packet):
    """Both ways: who speaks. The board answers each Hello with its own, and says one when it starts."""

    definitions: Annotated[int, Wire("I", meaning="hash of the packet definitions")]
    epoch: Annotated[int, Wire("H", meaning="this boot of the board, or this run of the host")]
    credit: Annotated[int, Wire("H", unit="B", meaning="bytes that the sender can take in at once")]


@_packet(0x0B, telemetry=TelemetryRate(1, 1))
class Status(Packet):
    """Board to host, 10 Hz: its state and its health."""

    time: Micros
    epoch: Annotated[int, Wire("H", meaning="this boot of the board")]
    flags: Annotated[int, Wire("B", meaning="see StatusFlag")]
    faults: Annotated[int, Wire("B", meaning="see SensorFault")]
    reset_cause: Annotated[int, Wire("B", meaning="see ResetCause")]
    battery: Annotated[float, Wire("H", scale=0.001, unit="V", meaning="battery")]
    loop_worst: Annotated[
        int, Wire("H", unit="µs", meaning="longest pass of the main loop since the last status")
    ]
    missed_ticks: Annotated[int, Wire("H", meaning="passes of the main loop missed since the start")]
    frames_invalid: Annotated[int, Wire("H", meaning="frames thrown away since the start")]
    bytes_lost: Annotated[int, Wire("H", meaning="received bytes lost for want of room since the start")]
    debug_lost: Annotated[int, Wire("H", meaning="debug lines lost for want of room since the start")]
    stack_free: Annotated[int, Wire("H", unit="B", meaning="memory that the stack never touched")]


@_packet(0x0C)
class Heartbeat(Packet):
    """Host to board, 10 Hz: somebody is there."""

    time: Annotated[int, Wire("I", unit="ms", meaning="the host's clock, for the log alone")]


@_packet(0x0D)
class Acknowledge(Packet):
    """Both ways: which reliable frames came after the first that is missing."""

    held: Annotated[int, Wire("B", meaning="bit n: frame acknowledged + 1 + n is here; bit 7: no room, wait")]


# The communication test: the messages of the thesis's Table 4, whose numbers are taken here.


@_packet(0x0E, reliable=True)
class TestMsg(Packet):
    """Both ways, in the communication test alone: a number."""

    number: Annotated[int, Wire("H")]


@_packet(0x0F, reliable=True)
class RequestResult(Packet):
    """Host to board, in the communication test alone: asks what has come."""


@_packet(0x10, reliable=True)
class TestResult(Packet):
    """Board to host, in the communication test alone: what has come."""

    right: Annotated[int, Wire("H", meaning="numbers of the test, each above all right ones before it")]
    out_of_sequence: Annotated[int, Wire("H", meaning="other numbers")]
    frames_invalid: Annotated[int, Wire("H", meaning="frames thrown away")]
    frames_repeated: Annotated[int, Wire("H", meaning="reliable frames sent again")]
    bytes_lost: Annotated[int, Wire("H", meaning="received bytes lost for want of room")]


# Hardware in the loop: a board without sensors and motors of its own is told by a simulator.


@_packet(0x11)
class Sense(Packet):
    """Host to board, in the loop with a simulator alone: what its sensors would show; the newest counts."""

    pressure: Annotated[int, Wire("I", unit="Pa", meaning="absolute pressure")]
    temperature: Annotated[float, Wire("h", scale=0.01, unit="°C", meaning="temperature of the water")]
    rate: Annotated[
        tuple[float, float, float],
        Wire("h", scale=0.00026632423, unit="rad/s", count=3, meaning="turn rate (65.5 counts per °/s)"),
    ]
    force: Annotated[
        tuple[float, float, float],
        Wire("h", scale=0.0011971008, unit="m/s²", count=3, meaning="specific force (8192 counts per g)"),
    ]
    right: Annotated[int, Wire("B", meaning="1 while the right detector sees the beacon")]
    left: Annotated[int, Wire("B", meaning="1 while the left detector sees the beacon")]
    battery: Annotated[float, Wire("H", scale=0.001, unit="V", meaning="battery")]


# What may be tuned while the board runs.


@_packet(0x12, reliable=True)
class Parameter(Packet):
    """Host to board: a value to take. Board to host, in answer: the value in force, taken or not."""

    number: Annotated[int, Wire("B", meaning="place in CHIP_PARAMETERS")]
    value: Annotated[float, Wire("H", scale=0.001, meaning="in the parameter's own unit")]


def encode(packet: Packet) -> bytes:
    """Type byte and payload. Raises LayoutError where a value cannot be written."""
    return bytes([packet.type]) + packet.to_bytes()


def decode(type_: int, payload: bytes | memoryview) -> Packet:
    """The packet of this type. Raises LayoutError on an unknown type or a wrong length."""
    cls = PACKETS.get(type_)
    if cls is None:
        raise LayoutError(f"unknown packet type 0x{type_:02x}")
    return cls.from_bytes(payload)


def canonical() -> str:
    """Everything that both sides must agree on, as text; its hash is what they compare."""
    lines = [f"fins {FIN_COUNT} frame {FRAME_BYTES_MAX} not_ready {NOT_READY}"]
    for type_, cls in sorted(PACKETS.items()):
        fields = [
            f"{name}:{wire.count}{wire.code}*{wire.scale!r}{wire.unit}" for name, wire in cls.wires.items()
        ]
        fields += [f"{cls.tail[0]}:text{cls.tail[1].max_bytes}"] if cls.tail else []
        lines.append(f"{type_:02x} {cls.__name__} reliable={cls.reliable:d} " + " ".join(fields))
    lines += [
        f"{enum.__name__} " + " ".join(f"{one.name}={one.value}" for one in enum) for enum in ENUMERATIONS
    ]
    lines += [str(one) for one in CHIP_PARAMETERS]
    return "\n".join(lines)


DEFINITIONS_HASH = int.from_bytes(sha256(canonical().encode()).digest()[:4], "little")
"""First four bytes, little-endian, of the SHA-256 of `canonical()`."""
