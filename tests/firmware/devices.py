"""Fake devices on the board's buses, as detailed as the firmware's drivers need."""

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass, field

CONVERSION_US = 4540
FORWARD, REVERSE = 1, 2
OVERCURRENT = 0b11


@dataclass
class ImuDevice:
    """An MPU-6050: registers, and a reading in raw counts."""

    force: tuple[int, int, int] = (0, 0, -8192)
    rate: tuple[int, int, int] = (0, 0, 0)
    identity: int = 0x68
    registers: dict[int, int] = field(default_factory=dict)

    def transfer(self, out: bytes, size: int) -> bytes:
        if len(out) == 2:
            self.registers[out[0]] = out[1]
            return b""
        if out == b"\x75":
            return bytes([self.identity])
        if out == b"\x1b":
            return bytes(self.registers.get(0x1B + index, 0) for index in range(size))
        assert out == b"\x3b"
        return struct.pack(">3hh3h", *self.force, 0, *self.rate)[:size]


@dataclass
class PressureSensor:
    """An MS5837-30BA with the data sheet's example of a PROM; conversions are given as raw counts.

    A conversion takes 4.54 ms, is spoiled if it is asked for before, and can be read once.
    """

    prom: list[int] = field(default_factory=lambda: [0, 34982, 36352, 20328, 22354, 26646, 26146])
    d1: int = 4958179
    d2: int = 6815414
    answer: bytes = b""
    now_us: Callable[[], int] = lambda: 0
    conversion: int = 0
    started_us: int = -CONVERSION_US

    def __post_init__(self) -> None:
        self.prom[0] = prom_checksum(self.prom) << 12

    def transfer(self, out: bytes, size: int) -> bytes:
        if not out:
            return self.answer[:size]
        command = out[0]
        if command >= 0xA0:
            self.answer = struct.pack(">H", self.prom[(command - 0xA0) // 2])
        elif command in {0x46, 0x56}:
            self.conversion = self.d1 if command == 0x46 else self.d2
            self.started_us = self.now_us()
        elif command == 0x00:
            early = self.now_us() - self.started_us < CONVERSION_US
            self.answer = struct.pack(">I", 0 if early else self.conversion)[1:]
            self.conversion = self.conversion // 2 if early else 0
        return b""

    def show(self, pressure: float) -> None:
        """Set the raw counts for this pressure (Pa), at the temperature of the example."""
        low, high = 0, 1 << 24
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (
                (middle, high) if compensate(self.prom, middle, self.d2)[0] <= pressure else (low, middle)
            )
        self.d1 = low


def prom_checksum(prom: list[int]) -> int:
    """Return the CRC-4 (x^4 + x + 1), by division, of the words without their checksum and a zero byte."""
    bits = "".join(f"{word:016b}" for word in [prom[0] & 0x0FFF, *prom[1:]]) + "0" * 8
    remainder = [int(bit) for bit in bits] + [0] * 4
    for i in range(len(bits)):
        if remainder[i]:
            for offset, bit in enumerate((1, 0, 0, 1, 1)):
                remainder[i + offset] ^= bit
    return int("".join(map(str, remainder[len(bits) :])), 2)


def compensate(prom: list[int], d1: int, d2: int) -> tuple[int, int]:
    """Pressure (Pa) and temperature (0.01 °C) by the data sheet's formulas, in whole numbers without end."""
    dt = d2 - prom[5] * 2**8
    temperature = 2000 + dt * prom[6] // 2**23
    off = prom[2] * 2**16 + prom[4] * dt // 2**7
    sens = prom[1] * 2**15 + prom[3] * dt // 2**8
    if temperature < 2000:
        ti = 3 * dt**2 // 2**33
        off_i, sens_i = 3 * (temperature - 2000) ** 2 // 2, 5 * (temperature - 2000) ** 2 // 2**3
        if temperature < -1500:
            off_i += 7 * (temperature + 1500) ** 2
            sens_i += 4 * (temperature + 1500) ** 2
    else:
        ti, off_i, sens_i = 2 * dt**2 // 2**37, (temperature - 2000) ** 2 // 2**4, 0
    return (d1 * (sens - sens_i) // 2**21 - (off - off_i)) * 10 // 2**13, temperature - ti


@dataclass
class BridgeDevice:
    """A DRV8830: the last drive written to it, and its fault register; with a fault it coasts.

    A `shorted` one trips whenever it drives.
    """

    control: int = 0
    fault: int = 0
    clears: int = 0
    shorted: bool = False

    def transfer(self, out: bytes, size: int) -> bytes:
        if size:
            assert out == b"\x01"
            return bytes([self.fault])
        if out[0] == 0:
            self.control = out[1]
            if self.shorted and self.drive:
                self.fault = OVERCURRENT
        elif out == b"\x01\x80":
            self.fault = 0
            self.clears += 1
        return b""

    @property
    def drive(self) -> int:
        """The drive, -63 to 63; 0 where it coasts."""
        size = 0 if self.fault else self.control >> 2
        return {FORWARD: size, REVERSE: -size}.get(self.control & 3, 0)


def encoder_word(
    counts: int,
    *,
    ready: int = 1,
    overflow: int = 0,
    nonlinear: int = 0,
    increase: int = 0,
    decrease: int = 0,
) -> int:
    """Return the AS5040's sixteen bits with even parity."""
    word = (counts % 1024) << 6 | ready << 5 | overflow << 4 | nonlinear << 3 | increase << 2 | decrease << 1
    return word | word.bit_count() % 2


@dataclass
class MotorDevice:
    """A gear motor that turns its shaft by its H-bridge's drive, at once, and friction-free.

    `leads` is -1 where they are swapped, 0 where the motor is jammed; `counting` is -1 where its encoder
    counts backwards.
    """

    zero: int
    rotation_sign: int
    shaft: float = 0.0
    leads: int = 1
    counting: int = 1

    SPEED = 0.3
    """rad/s a step of drive."""

    def turn(self, drive: int, seconds: float) -> None:
        self.shaft += self.leads * self.SPEED * drive * seconds

    @property
    def counts(self) -> int:
        """Reading of its encoder."""
        return round(self.zero - self.counting * self.shaft * 1024 / math.tau)

    @property
    def fin(self) -> float:
        """The fin's angle, rad."""
        return self.rotation_sign * self.shaft
