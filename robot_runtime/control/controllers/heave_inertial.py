"""A Kalman filter of depth and speed from accelerometer and pressure, without a model of the craft.

An accelerometer tells of every stroke of the fins, which no model knows, but shows a little too much or too
little all the time. How much, the depth tells in the long run, so that it is a third state beside depth and
speed (J. A. Farrell, Aided Navigation, 2008, 4.6).
"""

from robot_runtime.control.controllers.heave_observer import AGE
from robot_runtime.control.controllers.kalman import Matrix, dot, take_in

ACCELERATION_AGE = 0.012
"""s by which an acceleration is older than the tick that uses it."""
_DEPTH, _SPEED, _BIAS = 0.003, 0.01, 0.1
"""m, m/s, m/s²: standard deviations at the start."""
_NOISE, _WANDER = 0.012, 0.0005
"""m/s²: noise of the mean in a step; by which the bias may change in a step."""


class InertialHeave:
    """Follows a hull from a depth (m) and a speed (m/s, downwards) on."""

    def __init__(self, depth: float, speed: float) -> None:
        self._depth, self._speed, self._bias = depth, speed, 0.0
        self._covariance: Matrix = [[_DEPTH**2, 0.0, 0.0], [0.0, _SPEED**2, 0.0], [0.0, 0.0, _BIAS**2]]

    def observe(
        self, acceleration: float, measured: float, noise: float, seconds: float
    ) -> tuple[float, float]:
        """Depth and speed now, from the mean acceleration (m/s²) and depth (m) of the time since the last.

        `noise` is the standard deviation of that depth.
        """
        self._predict(acceleration, seconds)
        # The mean is that of the middle of the time.
        row = [1.0, -(seconds / 2 + AGE - ACCELERATION_AGE), 0.0]
        wrong = measured - dot(row, [self._depth, self._speed, self._bias])
        (depth, speed, bias), self._covariance = take_in(self._covariance, row, noise**2)
        self._depth += depth * wrong
        self._speed += speed * wrong
        self._bias += bias * wrong
        now = self._speed + (acceleration - self._bias) * ACCELERATION_AGE
        return self._depth + now * ACCELERATION_AGE, now

    def _predict(self, acceleration: float, seconds: float) -> None:
        gained = (acceleration - self._bias) * seconds
        self._depth += (self._speed + gained / 2) * seconds
        self._speed += gained
        change = [1.0, seconds, -(seconds**2) / 2], [0.0, 1.0, -seconds], [0.0, 0.0, 1.0]
        half = [[dot(row, column) for column in zip(*self._covariance, strict=True)] for row in change]
        self._covariance = [[dot(line, row) for row in change] for line in half]
        for place, deviation in enumerate((0.0, _NOISE * seconds, _WANDER)):
            self._covariance[place][place] += deviation**2
