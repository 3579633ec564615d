"""The gyroscope's offset, measured at rest."""

import threading
from collections.abc import Sequence
from statistics import fmean, pstdev
from typing import NamedTuple

from robot_runtime.contract.packets import Imu
from robot_runtime.errors import RefusedError

SECONDS = 3.0
"""s over which the turn rate is averaged."""
_PATIENCE = 3.0
"""s beyond, in which the readings must have come."""
_STILL = 0.02
"""rad/s, standard deviation at rest: ten times the noise of an MPU-6050 behind its 44 Hz filter."""
_STEADY = 0.01
"""rad/s between the means of both halves: something that begins or ends to turn."""

Rate = tuple[float, float, float]


class Rest(NamedTuple):
    """The turn rate of a gyroscope that should be at rest."""

    rate: Rate
    """Its mean, rad/s."""
    moved: int | None
    """The axis about which it moved; None: it lay still."""
    stuck: bool
    """True where no reading differs from another, as a sound gyroscope's do."""


def judge_rest(rates: Sequence[Rate]) -> Rest:
    """Judge whether a gyroscope lay still while it gave these readings, two at least."""
    half = len(rates) // 2
    axes = [[rate[axis] for rate in rates] for axis in range(3)]
    deviations = [pstdev(axis) for axis in axes]
    moved = [
        number
        for number, (axis, deviation) in enumerate(zip(axes, deviations, strict=True))
        if deviation > _STILL or abs(fmean(axis[:half]) - fmean(axis[half:])) > _STEADY
    ]
    x, y, z = map(fmean, axes)
    return Rest((x, y, z), moved[0] if moved else None, max(deviations) == 0)


class GyroMeasurement:
    """The mean turn rate of a robot that lies still. `see` may be called from another thread."""

    def __init__(self) -> None:
        self._rates: list[Rate] = []
        self._since: float | None = None
        self._complete = threading.Event()

    def see(self, time: float, record: bytes) -> None:
        """Take a reading of the IMU at `time` (s)."""
        if self._complete.is_set():
            return
        if self._since is None:
            self._since = time
        self._rates.append(Imu.from_bytes(record).rate)
        if time - self._since >= SECONDS:
            self._complete.set()

    def result(self) -> Rate:
        """Wait for the readings; return their mean, rad/s.

        Raise RefusedError where they do not come, where all readings are equal, or where the robot moved.
        """
        if not self._complete.wait(SECONDS + _PATIENCE):
            raise RefusedError("The IMU sent too few readings. Check it, and try again.")
        rest = judge_rest(self._rates)
        if rest.stuck:
            raise RefusedError(
                "The readings do not change at all: the IMU has stopped. Reset the board, and try again."
            )
        if rest.moved is not None:
            name = ("forward", "right", "down")[rest.moved]
            raise RefusedError(
                f"The robot moved about its {name} axis. Lay it down where nothing shakes it; try again."
            )
        return rest.rate
