"""The gyroscope's offset, measured at rest."""

import threading
from statistics import fmean, pstdev

from robot_runtime.contract.packets import Imu
from robot_runtime.errors import RefusedError

SECONDS = 3.0
"""s over which the turn rate is averaged."""
_PATIENCE = 3.0
"""s beyond, in which the readings must have come."""
STILL = 0.02
"""rad/s, standard deviation at rest: ten times the noise of an MPU-6050 behind its 44 Hz filter."""
_STEADY = 0.01
"""rad/s between the means of both halves: something that begins or ends to turn."""

Rate = tuple[float, float, float]


class GyroMeasurement:
    """Averages the turn rate while the robot lies still. `see` may be called from another thread."""

    def __init__(self) -> None:
        self._rates: list[Rate] = []
        self._since: float | None = None
        self._complete = threading.Event()

    def see(self, time: float, record: bytes) -> None:
        """Takes a reading of the IMU at `time` (s)."""
        if self._complete.is_set():
            return
        if self._since is None:
            self._since = time
        self._rates.append(Imu.from_bytes(record).rate)
        if time - self._since >= SECONDS:
            self._complete.set()

    def result(self) -> Rate:
        """Waits for the readings; returns their mean, rad/s.

        Raises RefusedError where they do not come, or where the robot moved.
        """
        if not self._complete.wait(SECONDS + _PATIENCE):
            raise RefusedError("The IMU sent too few readings. Check it, and try again.")
        for axis, name in enumerate(("forward", "right", "down")):
            rates = [rate[axis] for rate in self._rates]
            half = len(rates) // 2
            drift = abs(fmean(rates[:half]) - fmean(rates[half:]))
            if pstdev(rates) > STILL or drift > _STEADY:
                raise RefusedError(
                    f"The robot moved about its {name} axis. Lay it down where nothing shakes it; try again."
                )
        forward, right, down = (fmean(rate[axis] for rate in self._rates) for axis in range(3))
        return forward, right, down
