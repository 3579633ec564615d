"""A board's calibration: the numbers that differ between robots, for people and as the board stores them.

The board keeps it in EEPROM as a record: a version, the payload of the packet CALIBRATION, and the CRC-32 of
both, little-endian. The version is taken from the packet's layout: a record of another layout does not count.
"""

from dataclasses import dataclass, field
from hashlib import sha256
from typing import Annotated, Literal
from zlib import crc32

from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.packets import Calibration, CalibrationStep
from robot_runtime.contract.packets.definitions import describe_packet

RECORD_ADDRESS = 16
"""Its place in EEPROM, behind the boot counter."""
RECORD_VERSION = sha256(describe_packet(Calibration).encode()).digest()[0]

StepName = Literal["fins", "motors", "axes", "gyro", "pressure", "battery", "beacons"]
STEPS: dict[StepName, str] = {
    "fins": "zeros and directions of the fins",
    "motors": "directions of the motors",
    "axes": "axes of the IMU",
    "gyro": "offset of the gyroscope",
    "pressure": "offset of the pressure sensor",
    "battery": "factor of the battery's voltage",
    "beacons": "polarity of the beacon detectors",
}
"""Each step of a calibration in words; the board arms only when all are done."""

Axis = Literal["x", "-x", "y", "-y", "z", "-z"]
_AXES: tuple[Axis, ...] = ("x", "y", "z", "-z", "-y", "-x")
"""By the packet's number: 1, 2, 3 and, from the end, -1, -2, -3."""
FinZero = Annotated[int, Range(0, 1023)]
GYRO_BIAS = Range(-0.7, 0.7)
"""rad/s; twice what the data sheet of the MPU-6050 allows."""
GyroBias = Annotated[float, GYRO_BIAS]
PressureOffset = Annotated[int, Range(-20000, 20000)]
"""Pa."""
BatteryFactor = Annotated[float, Range(0.8, 1.25)]


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationValues:
    """A robot's calibration as its board keeps it. Fins: front right, back right, back left, front left."""

    done: tuple[StepName, ...] = field(metadata={"description": "the steps that are done"})
    fin_zeros: tuple[FinZero, FinZero, FinZero, FinZero] = field(
        metadata={"description": "encoder counts, 1024 a turn, where each fin points along its mount"}
    )
    encoders_reversed: tuple[bool, bool, bool, bool] = field(
        metadata={"description": "whether the counts fall as the fin's tip goes down"}
    )
    motors_reversed: tuple[bool, bool, bool, bool] = field(
        metadata={"description": "whether the counts fall at positive drive"}
    )
    axes: tuple[Axis, Axis, Axis] = field(
        metadata={"description": "the IMU chip's axes that point forward, right, down; -: away from it"}
    )
    gyro_bias: tuple[GyroBias, GyroBias, GyroBias] = field(
        metadata={"description": "rad/s, measured at rest; forward, right, down"}
    )
    pressure_offset: PressureOffset = field(metadata={"description": "Pa that the sensor shows too much"})
    battery_factor: BatteryFactor = field(
        metadata={"description": "the battery's true voltage over the measured one"}
    )
    beacons_inverted: bool = field(
        metadata={"description": "whether a detector's pin is low while it sees the beacon"}
    )

    def __post_init__(self) -> None:
        if not _is_turn(self.axes):
            raise ConfigError(
                f"axes are {', '.join(self.axes)}; they must be three different axes of the chip, as it lies "
                "after a turn: a mirrored chip does not exist"
            )

    @property
    def missing(self) -> list[StepName]:
        """The steps that are not done, in their order."""
        return [name for name in STEPS if name not in self.done]

    def packet(self) -> Calibration:
        """Return the packet that carries these values."""
        forward, right, down = map(_axis_number, self.axes)
        return Calibration(
            done=sum(CalibrationStep[name.upper()] for name in set(self.done)),
            fin_zeros=self.fin_zeros,
            encoders_reversed=_bits(self.encoders_reversed),
            motors_reversed=_bits(self.motors_reversed),
            axes=(forward, right, down),
            gyro_bias=self.gyro_bias,
            pressure_offset=self.pressure_offset,
            battery_factor=self.battery_factor,
            beacons_inverted=self.beacons_inverted,
        )

    @classmethod
    def from_packet(cls, packet: Calibration) -> "CalibrationValues":
        """Return the calibration of a board's answer. Raise ConfigError where its axes are impossible."""
        if not all(1 <= abs(number) <= 3 for number in packet.axes):
            raise ConfigError(f"the board keeps impossible axes: {packet.axes}")
        forward, right, down = map(_axis, packet.axes)
        return cls(
            done=tuple(name for name in STEPS if packet.done & CalibrationStep[name.upper()]),
            fin_zeros=packet.fin_zeros,
            encoders_reversed=_flags(packet.encoders_reversed),
            motors_reversed=_flags(packet.motors_reversed),
            axes=(forward, right, down),
            gyro_bias=packet.gyro_bias,
            pressure_offset=packet.pressure_offset,
            battery_factor=packet.battery_factor,
            beacons_inverted=bool(packet.beacons_inverted),
        )


def _bits(flags: tuple[bool, bool, bool, bool]) -> int:
    return sum(1 << number for number, on in enumerate(flags) if on)


def _flags(bits: int) -> tuple[bool, bool, bool, bool]:
    return bool(bits & 1), bool(bits & 2), bool(bits & 4), bool(bits & 8)


def _axis(number: int) -> Axis:
    return _AXES[number - 1 if number > 0 else number]


def _axis_number(axis: Axis) -> int:
    index = _AXES.index(axis)
    return index + 1 if index < 3 else index - len(_AXES)


def _is_turn(axes: tuple[Axis, Axis, Axis]) -> bool:
    """Return True where the axes are right-handed: the third is the cross product of the first two."""
    forward, right, down = ((_axis_number(axis), abs(_axis_number(axis)) - 1) for axis in axes)
    if (right[1] - forward[1]) % 3 == 0:
        return False
    cyclic = (right[1] - forward[1]) % 3 == 1
    sign = (forward[0] > 0) == (right[0] > 0)
    third = 3 - forward[1] - right[1]
    return down[1] == third and (down[0] > 0) == (sign == cyclic)


EMULATED = CalibrationValues(
    done=tuple(STEPS),
    fin_zeros=(188, 161, 726, 356),
    encoders_reversed=(True, True, False, False),
    motors_reversed=(True, True, True, True),
    axes=("x", "y", "z"),
    gyro_bias=(0.0, 0.0, 0.0),
    pressure_offset=0,
    battery_factor=1.0,
    beacons_inverted=False,
)
"""The calibration of the emulated board."""


def record(calibration: Calibration) -> bytes:
    """Return the record's bytes, which a board stores at `RECORD_ADDRESS`."""
    body = bytes([RECORD_VERSION]) + calibration.to_bytes()
    return body + crc32(body).to_bytes(4, "little")
