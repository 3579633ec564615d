"""The packets of the serial link. `make generate` writes the firmware's and the documentation's copy of them.

The first eight types keep the numbers of the thesis's Table 3. Body axes are forward, right, down; the world
is north, east, down, where north is the robot's heading at the board's start. Fin order: front right,
back right, back left, front left. A fin's angle is 0 where its tip lies along its mount (outwards and aft for
the front fins, outwards and forward for the back fins) and grows as the tip goes down.
"""

from collections.abc import Callable
from enum import IntEnum, IntFlag, unique
from hashlib import sha256
from typing import Annotated, ClassVar, NamedTuple, TypeVar, dataclass_transform

from robot_runtime.contract.declarations import Declarations
from robot_runtime.contract.packets.chip_parameters import CHIP_PARAMETERS
from robot_runtime.contract.packets.layout import LayoutError, Record, Text, Wire, record

FIN_COUNT = 4
FRAME_BYTES_MAX = 64
"""Bytes of a whole frame on the serial line: overhead, messages and the closing zero."""

NOT_READY = 0x80
"""In ACKNOWLEDGE, beside the bits of held frames: the sender has no room for the next reliable frame."""

Micros = Annotated[int, Wire("I", unit="µs", meaning="the board's own clock, which wraps after 71 minutes")]
Fins = tuple[float, float, float, float]
Quaternion = tuple[float, float, float, float]


@unique
class DebugLevel(IntEnum):
    """The severity of a line of debug text."""

    DEBUG = 0
    INFO = 1
    WARNING = 2
    ERROR = 3


@unique
class StatusFlag(IntFlag):
    """Flags of the board's state, one bit each."""

    ARMED = 1
    HOST_ALIVE = 2
    NEUTRAL = 4
    MOTOR_POWER = 8
    BATTERY_LOW = 16
    DEFINITIONS_DIFFER = 32
    HIL = 64


@unique
class DeviceFault(IntFlag):
    """Faults of the board's devices; one bit each.

    The last reading of an IMU, a pressure sensor or an encoder failed or was invalid; a powered H-bridge does
    not answer or reports a fault; a fin turned against its drive or not at all, and is not driven until the
    next arming; the magnet of an encoder is too near or too far, and the fin's angle is less exact; the depth
    is that below the surface before the supply failed under water, and the board does not arm; there is water
    in the hull, and the board does not arm before its next start.
    """

    IMU = 1
    PRESSURE = 2
    ENCODER_FRONT_RIGHT = 4
    ENCODER_BACK_RIGHT = 8
    ENCODER_BACK_LEFT = 16
    ENCODER_FRONT_LEFT = 32
    BRIDGE_FRONT_RIGHT = 64
    BRIDGE_BACK_RIGHT = 128
    BRIDGE_BACK_LEFT = 256
    BRIDGE_FRONT_LEFT = 512
    TRACKING_FRONT_RIGHT = 1024
    TRACKING_BACK_RIGHT = 2048
    TRACKING_BACK_LEFT = 4096
    TRACKING_FRONT_LEFT = 8192
    MAGNET = 16384
    SURFACE = 32768
    LEAK = 65536


@unique
class ResetCause(IntEnum):
    """Cause of the board's last start."""

    UNKNOWN = 0
    POWER_ON = 1
    EXTERNAL = 2
    BROWN_OUT = 3
    WATCHDOG = 4


@unique
class CalibrationStep(IntFlag):
    """The steps of a board's calibration, one bit each."""

    FINS = 1
    MOTORS = 2
    AXES = 4
    GYRO = 8
    PRESSURE = 16
    BATTERY = 32
    BEACONS = 64


@unique
class BoardEventKind(IntEnum):
    """The board's events, with their details and values.

    BOOT: the ResetCause, and the epoch. REFUSED (a START): the Refusal, and the missing steps of the
    calibration. DISARMED: the Disarming. BATTERY: 1 if the robot was armed, and mV. FAULT and FAULT_OVER: the
    number of the bit in DeviceFault, and the IMU's WHO_AM_I.
    """

    BOOT = 0
    ARMED = 1
    REFUSED = 2
    DISARMED = 3
    BATTERY = 4
    FAULT = 5
    FAULT_OVER = 6


@unique
class Refusal(IntEnum):
    """The board's reason to refuse a START."""

    NONE = 0
    NO_HELLO = 1
    DEFINITIONS = 2
    EPOCH = 3
    TRAFFIC = 4
    BATTERY = 5
    CALIBRATION = 6
    SURFACE = 7
    LEAK = 8


@unique
class Disarming(IntEnum):
    """The board's reason to disarm."""

    NONE = 0
    STOP = 1
    SILENCE = 2
    BATTERY = 3
    DEFINITIONS = 4
    HOST = 5
    LEAK = 6


ENUMERATIONS: tuple[type[IntEnum] | type[IntFlag], ...] = (
    DebugLevel,
    StatusFlag,
    DeviceFault,
    ResetCause,
    CalibrationStep,
    BoardEventKind,
    Refusal,
    Disarming,
)


class TelemetryRate(NamedTuple):
    """Packets per ten slots of the board's schedule, and per three slots on a slow line."""

    in_ten: int
    in_three: int


class Packet(Record):
    """Base of all packets: a record with a type number.

    A reliable packet is sent again until it is acknowledged; any other is superseded by the next one.
    """

    __slots__ = ()
    type: ClassVar[int]
    reliable: ClassVar[bool]
    telemetry: ClassVar[TelemetryRate | None]


P = TypeVar("P", bound=Packet)
PACKETS: Declarations[int, type[Packet]] = Declarations("the number of a packet")


@dataclass_transform(frozen_default=True, kw_only_default=True)
def _packet(
    type_: int, *, reliable: bool = False, telemetry: TelemetryRate | None = None
) -> Callable[[type[P]], type[P]]:
    def register(cls: type[P]) -> type[P]:
        made = record()(cls)
        made.type = type_
        made.reliable = reliable
        made.telemetry = telemetry
        PACKETS.add(type_, made, depth=1)
        return made

    return register


@_packet(0x00)
class Stop(Packet):
    """Host to board: disarm at once. Always accepted, also outside a session and repeatedly."""


@_packet(0x01, reliable=True)
class Start(Packet):
    """Host to board: arm. Refused unless the epoch is this boot's and valid traffic came for 500 ms."""

    epoch: Annotated[int, Wire("H", meaning="epoch of the addressed boot, from the board's Hello; 0: none")]


@_packet(0x02)
class Navigation(Packet):
    """Host to board: the commanded force and torque, each as a share of the maximum. Expires after 250 ms."""

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
    """Board to host, 10 Hz: the light-beacon detectors."""

    time: Micros
    right: Annotated[int, Wire("B", meaning="1 while the right detector sees the beacon")]
    left: Annotated[int, Wire("B", meaning="1 while the left detector sees the beacon")]


@_packet(0x06, telemetry=TelemetryRate(5, 1))
class Motor(Packet):
    """Board to host, 50 Hz: commanded and measured angles of the four fins, and the H-bridge commands."""

    time: Micros
    wanted: Annotated[Fins, Wire("h", scale=0.001, unit="rad", count=4, meaning="commanded fin angle")]
    angle: Annotated[Fins, Wire("h", scale=0.001, unit="rad", count=4, meaning="measured fin angle")]
    drive: Annotated[Fins, Wire("b", count=4, meaning="H-bridge command, -63 to 63")]


@_packet(0x09, reliable=True)
class Debug(Packet):
    """Board to host: a line of text, from a sketch of one's own."""

    time: Micros
    level: Annotated[int, Wire("B", meaning="see DebugLevel")]
    text: Annotated[str, Text(40)]


@_packet(0x0A)
class Hello(Packet):
    """Both ways: identifies the sender. The board answers each Hello, and sends one at its start."""

    definitions: Annotated[int, Wire("I", meaning="hash of the packet definitions")]
    epoch: Annotated[int, Wire("H", meaning="epoch of the board's boot or of the host's run")]
    credit: Annotated[int, Wire("H", unit="B", meaning="bytes that the sender can receive at once")]


@_packet(0x0B, telemetry=TelemetryRate(1, 1))
class Status(Packet):
    """Board to host, 10 Hz: the board's state and health."""

    time: Micros
    epoch: Annotated[int, Wire("H", meaning="epoch of the board's boot")]
    flags: Annotated[int, Wire("B", meaning="see StatusFlag")]
    faults: Annotated[int, Wire("I", meaning="see DeviceFault")]
    reset_cause: Annotated[int, Wire("B", meaning="see ResetCause")]
    battery: Annotated[float, Wire("H", scale=0.001, unit="V", meaning="battery voltage")]
    loop_worst: Annotated[
        int, Wire("H", unit="µs", meaning="longest pass of the main loop since the last status")
    ]
    missed_ticks: Annotated[int, Wire("H", meaning="passes of the main loop missed since the start")]
    frames_invalid: Annotated[int, Wire("H", meaning="invalid frames dropped since the start")]
    bytes_lost: Annotated[int, Wire("H", meaning="received bytes lost to a full buffer since the start")]
    debug_lost: Annotated[int, Wire("H", meaning="events and lines lost to a full buffer since the start")]
    stack_free: Annotated[int, Wire("H", unit="B", meaning="memory that the stack has never used")]


@_packet(0x0C)
class Heartbeat(Packet):
    """Host to board, 10 Hz: the host is alive."""

    time: Annotated[int, Wire("I", unit="ms", meaning="the host's clock, for logs only")]


@_packet(0x0D)
class Acknowledge(Packet):
    """Both ways: the reliable frames received after the first missing one."""

    held: Annotated[int, Wire("B", meaning="bit n: frame acknowledged + 1 + n was received; bit 7: no room")]


# The communication test: the messages of the thesis's Table 4, with other type numbers.


@_packet(0x0E, reliable=True)
class TestMsg(Packet):
    """Both ways, only in the communication test: a number."""

    number: Annotated[int, Wire("H")]


@_packet(0x0F, reliable=True)
class RequestResult(Packet):
    """Host to board, only in the communication test: asks for the result."""


@_packet(0x10, reliable=True)
class TestResult(Packet):
    """Board to host, only in the communication test: counts of received numbers and frames."""

    right: Annotated[int, Wire("H", meaning="numbers of the test in ascending order")]
    out_of_sequence: Annotated[int, Wire("H", meaning="other numbers")]
    frames_invalid: Annotated[int, Wire("H", meaning="invalid frames dropped")]
    frames_repeated: Annotated[int, Wire("H", meaning="reliable frames sent again")]
    bytes_lost: Annotated[int, Wire("H", meaning="received bytes lost to a full buffer")]


# Hardware in the loop: a board without sensors and motors gets its readings from a simulator.


@_packet(0x11)
class Sense(Packet):
    """Host to board, only with hardware in the loop: simulated sensor readings; the newest counts."""

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
    battery: Annotated[float, Wire("H", scale=0.001, unit="V", meaning="battery voltage")]


# Parameters of the running board.


@_packet(0x12, reliable=True)
class Parameter(Packet):
    """Host to board: a new value of a parameter. Board to host, in answer: the value in force."""

    number: Annotated[int, Wire("B", meaning="index in CHIP_PARAMETERS")]
    value: Annotated[float, Wire("H", scale=0.001, meaning="in the parameter's own unit")]


# What differs from robot to robot.


@_packet(0x13, reliable=True)
class Calibration(Packet):
    """Host to board: the calibration to keep. Board to host, in answer: the one that it keeps in EEPROM.

    A board arms only when every step is done. While it is armed it keeps what it has.
    """

    done: Annotated[int, Wire("B", meaning="see CalibrationStep")]
    fin_zeros: Annotated[
        tuple[int, int, int, int],
        Wire("H", count=4, meaning="encoder counts, 1024 a turn, where the fin points along its mount"),
    ]
    encoders_reversed: Annotated[int, Wire("B", meaning="bit n: fin n's counts fall as its tip goes down")]
    motors_reversed: Annotated[int, Wire("B", meaning="bit n: fin n's counts fall at positive drive")]
    axes: Annotated[
        tuple[int, int, int],
        Wire("b", count=3, meaning="the chip's axes, 1 to 3, that point forward, right, down; -: away"),
    ]
    gyro_bias: Annotated[
        tuple[float, float, float],
        Wire(
            "h", scale=0.00026632423, unit="rad/s", count=3, meaning="turn rate measured at rest, body axes"
        ),
    ]
    pressure_offset: Annotated[int, Wire("h", unit="Pa", meaning="what the sensor shows too much")]
    battery_factor: Annotated[float, Wire("H", scale=0.0001, meaning="true battery voltage over measured")]
    beacons_inverted: Annotated[int, Wire("B", meaning="1: a detector's pin is low while it sees the beacon")]


@_packet(0x14, reliable=True)
class RequestCalibration(Packet):
    """Host to board: asks for the calibration that it keeps."""


@_packet(0x15, reliable=True)
class ZeroDepth(Packet):
    """Host to board: the pressure now is the surface's. Ignored while armed."""


# The bring-up: what the robot's own firmware does not do. Its sketch is firmware/examples/bring_up.


@_packet(0x16, reliable=True)
class RequestScan(Packet):
    """Host to board, only in the bring-up: asks which devices answer on I2C, with power on the motors."""


@_packet(0x17, reliable=True)
class Scan(Packet):
    """Board to host, only in the bring-up: the addresses that answered."""

    answered: Annotated[tuple[int, ...], Wire("B", count=16, meaning="bit a % 8 of byte a / 8: address a")]


@_packet(0x18)
class Jog(Packet):
    """Host to board, only in the bring-up: drives one motor, for 250 ms."""

    fin: Annotated[int, Wire("B", meaning="0 to 3, by the H-bridge's address")]
    drive: Annotated[int, Wire("b", meaning="H-bridge command, -20 to 20")]


@_packet(0x19)
class Raw(Packet):
    """Board to host, only in the bring-up, 20 Hz: the devices' raw readings."""

    time: Micros
    encoders: Annotated[
        tuple[int, int, int, int], Wire("H", count=4, meaning="the AS5040's words: 10 bits, then status")
    ]
    identity: Annotated[int, Wire("B", meaning="the IMU's WHO_AM_I; 0 where nothing answers")]
    rate: Annotated[
        tuple[float, float, float],
        Wire("h", scale=0.00026632423, unit="rad/s", count=3, meaning="turn rate about the chip's axes"),
    ]
    force: Annotated[
        tuple[float, float, float],
        Wire("h", scale=0.0011971008, unit="m/s²", count=3, meaning="specific force along the chip's axes"),
    ]
    pressure: Annotated[int, Wire("I", unit="Pa", meaning="absolute pressure; 0 where nothing answers")]
    temperature: Annotated[float, Wire("h", scale=0.01, unit="°C", meaning="temperature of the water")]
    battery: Annotated[int, Wire("H", meaning="the converter's counts, 1023 for twice 5 V")]
    beacons: Annotated[int, Wire("B", meaning="levels of the detectors' pins; bit 0: right, bit 1: left")]
    leak: Annotated[int, Wire("B", meaning="1 while the leak sensor is wet")]


@_packet(0x1A, reliable=True)
class BoardEvent(Packet):
    """Board to host: an event, which the host puts into words (`robot_runtime/contract/board_events.py`)."""

    time: Micros
    kind: Annotated[int, Wire("B", meaning="see BoardEventKind")]
    detail: Annotated[int, Wire("B", meaning="as the kind says")]
    value: Annotated[int, Wire("H", meaning="as the kind says")]


@_packet(0x1B)
class Countdown(Packet):
    """Host to board: the LED of an armed robot counts down. Expires after 300 ms."""

    remaining: Annotated[float, Wire("B", scale=0.1, unit="s", meaning="time until the end of the countdown")]


def encode(packet: Packet) -> bytes:
    """Return type byte and payload. Raise LayoutError where a value cannot be written."""
    return bytes([packet.type]) + packet.to_bytes()


def decode(type_: int, payload: bytes | memoryview) -> Packet:
    """Return the packet of this type. Raise LayoutError on an unknown type or a wrong length."""
    cls = PACKETS.get(type_)
    if cls is None:
        raise LayoutError(f"unknown packet type 0x{type_:02x}")
    return cls.from_bytes(payload)


def describe_packet(cls: type[Packet]) -> str:
    """Return a packet's type number and layout as a line of text."""
    fields = [f"{name}:{wire.count}{wire.code}*{wire.scale!r}{wire.unit}" for name, wire in cls.wires.items()]
    fields += [f"{cls.tail[0]}:text{cls.tail[1].max_bytes}"] if cls.tail else []
    return f"{cls.type:02x} {cls.__name__} reliable={cls.reliable:d} " + " ".join(fields)


def canonical() -> str:
    """Return the definitions that both ends must share, as text; the ends compare its hash."""
    lines = [f"fins {FIN_COUNT} frame {FRAME_BYTES_MAX} not_ready {NOT_READY}"]
    lines += [describe_packet(cls) for _, cls in sorted(PACKETS.items())]
    lines += [
        f"{enum.__name__} " + " ".join(f"{member.name}={member.value}" for member in enum)
        for enum in ENUMERATIONS
    ]
    lines += [str(parameter) for parameter in CHIP_PARAMETERS]
    return "\n".join(lines)


DEFINITIONS_HASH = int.from_bytes(sha256(canonical().encode()).digest()[:4], "little")
"""First four bytes, little-endian, of the SHA-256 of `canonical()`."""
