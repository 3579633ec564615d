"""The readings that the bring-up's sketch sends, in terms of the parts."""

from collections.abc import Sequence
from itertools import pairwise
from statistics import fmean
from typing import Literal

from robot_runtime.contract.packets import FIN_COUNT, Raw

Field = Literal["green", "yellow", "red", "silent"]
Three = tuple[float, float, float]

COUNTS_PER_TURN = 1024
GRAVITY = 9.80665
"""m/s²."""
BATTERY_VOLTS = 10 / 1023
"""V for each of the converter's counts: 5 V behind a divider of two equal resistors."""

# The AS5040's word, behind its leading 1: ten bits of angle, then these, then even parity (data sheet).
_NOTHING = 0xFFFF
_OFFSET_DONE, _OVERFLOW, _LINEARITY, _BOTH_MAG = 1 << 5, 1 << 4, 1 << 3, 3 << 1


def counts(word: int) -> int:
    """Return the angle of an encoder, 0 to 1023."""
    return word >> 6


def field(word: int) -> Field:
    """Return the state of an encoder's magnet in the data sheet's colours, or silent without an answer."""
    # Without an encoder the pull-up of its line reads as ones.
    if word == _NOTHING or word.bit_count() % 2 or not word & _OFFSET_DONE:
        return "silent"
    if word & _OVERFLOW or (word & _BOTH_MAG == _BOTH_MAG and word & _LINEARITY):
        return "red"
    return "yellow" if word & _BOTH_MAG == _BOTH_MAG else "green"


def movements(raws: Sequence[Raw]) -> list[int]:
    """Return the counts that each encoder turned between first and last reading, whole turns included."""
    moved = [0] * FIN_COUNT
    for before, after in pairwise(raws):
        for fin in range(FIN_COUNT):
            moved[fin] += wrap(counts(after.encoders[fin]) - counts(before.encoders[fin]))
    return moved


def wrap(difference: int) -> int:
    """Return a difference of counts, the shortest way round: -512 to 511."""
    return (difference + COUNTS_PER_TURN // 2) % COUNTS_PER_TURN - COUNTS_PER_TURN // 2


def mean_force(raws: Sequence[Raw]) -> Three:
    """Return the mean specific force along the chip's axes, in g."""
    x, y, z = (fmean(raw.force[axis] for raw in raws) / GRAVITY for axis in range(3))
    return x, y, z


def mean_pressure(raws: Sequence[Raw]) -> float:
    """Return the mean pressure, Pa, of the sensor's readings; 0 without a reading."""
    given = [raw.pressure for raw in raws if raw.pressure]
    return fmean(given) if given else 0.0


def mean_volts(raws: Sequence[Raw]) -> float:
    """Return the battery's mean voltage as the board would show it without a calibration, in V."""
    return fmean(raw.battery for raw in raws) * BATTERY_VOLTS
