"""The text protocol between the water and the emulated board, without I/O.

The board sends its fins, `fins TIME A0..A3 S0..S3 D0..D3 POWER LED`, and waits for the answer
`sense PRESSURE TEMPERATURE FX FY FZ P Q R BEACON_RIGHT BEACON_LEFT BATTERY E0 E1 E2 E3 FIN_LOAD`.
"""

from collections.abc import Iterator
from math import isfinite

from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion

LINE_BYTES_MAX = 1024
FIN_NUMBERS = 15
SWING_MAX = 1000.0
"""Largest angle, rad, and speed, rad/s, of a fin; larger numbers would break the physics."""


class BoardLineError(ValueError):
    """The board sent an invalid line; the text says what is wrong with it."""


class LineBuffer:
    """Assembles lines from received bytes."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[str]:
        """Yield the lines that `data` completes, without line ends. Raise BoardLineError on a long line."""
        *whole, self._rest = (self._rest + data).split(b"\n")
        if len(self._rest) > LINE_BYTES_MAX:
            raise BoardLineError(f"a line of more than {LINE_BYTES_MAX} bytes")
        for line in whole:
            yield line.decode("utf-8", "replace").strip()


def read_fins(line: str) -> FinMotion:
    """Return the fins of a `fins` line. Raise BoardLineError if it is invalid."""
    word, *texts = line.split()
    if word != "fins" or len(texts) != FIN_NUMBERS:
        raise BoardLineError(f"{line!r} is not `fins` and {FIN_NUMBERS} numbers")
    try:
        numbers = [float(text) for text in texts]
    except ValueError as problem:
        raise BoardLineError(f"{line!r}: {problem}") from problem
    if not all(map(isfinite, numbers)) or max(map(abs, numbers[1:9])) > SWING_MAX:
        raise BoardLineError(f"{line!r} has impossible fins: angle or speed beyond {SWING_MAX:g}")
    return FinMotion.of(numbers[1:14])


def write_sense(reading: Reading) -> str:
    """Return the answer to a `fins` line, with its line end."""
    numbers = (*reading.force, *reading.rate)
    motion = " ".join(f"{number:.6f}" for number in numbers)
    encoders = " ".join(f"{error:.5f}" for error in reading.encoders)
    return (
        f"sense {reading.pressure:.1f} {reading.temperature:.2f} {motion} "
        f"{reading.beacon_right:d} {reading.beacon_left:d} {reading.battery:.4f} {encoders} "
        f"{reading.fin_load:.4f}\n"
    )
