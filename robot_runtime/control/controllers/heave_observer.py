"""An extended Kalman filter of depth, speed and the parameters of the `Heave` model.

Its state is depth, speed, and four parameters of the model that no reading shows by itself: the strength of
the fins, the resistance of blades and hull, and the drift (augmented state, A. Gelb, Applied Optimal
Estimation, 1974, 9.4). What they may be at first is told by their covariance: another mass changes the first
three together.
"""

from robot_runtime.control.controllers.heave import Heave, Motion
from robot_runtime.control.controllers.kalman import Matrix, dot, take_in

LAG = 0.05
"""s from a command to when the fins have followed it."""
AGE = 0.033
"""s by which a reading is older than the tick that uses it."""
_STEP = 0.02
"""s of the model's steps."""
_AWASH = 0.008
"""m of depth above which waves and the surface act on the hull, and nothing is learnt of the craft."""
_DEPTH, _SPEED = 0.003, 0.01
"""m, m/s: standard deviations at the start; so are the next."""
_MASS, _STRENGTH, _BLADES, _HULL, _DRIFT = 0.15, 0.3, 0.05, 0.3, 0.006
_CALM, _PUSHED, _PADDLED = 0.001, 0.02, 0.15
"""m/s by which the speed may be off after a step; for each m/s² of push, which comes in strokes; as a share
of what the blades did to it."""
_CHANGE = (0.002, 0.002, 0.002, 0.0002)
"""By which the parameters may change in a step."""
_RANGE = (0.5, 1.6)
"""Of the three shares."""
_DRIFT_MAX = 0.03
"""m/s²."""


class HeaveObserver:
    """Follows the motion of a hull; `heave` is the model with what is learnt."""

    def __init__(self, heave: Heave) -> None:
        self.heave = heave
        self._earlier = 0.0
        common = _MASS**2
        self._covariance: Matrix = [
            [_DEPTH**2, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, _SPEED**2, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, common + _STRENGTH**2, common, common, 0.0],
            [0.0, 0.0, common, common + _BLADES**2, common, 0.0],
            [0.0, 0.0, common, common, common + _HULL**2, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, _DRIFT**2],
        ]

    def observe(
        self, motion: Motion, command: float, measured: float, noise: float, seconds: float
    ) -> Motion:
        """The motion now, from that `seconds` ago, the command since, and the mean depth measured since.

        `noise` is the standard deviation of that mean, m.
        """
        motion = self._predict(motion, command, seconds)
        # The mean is that of the middle of the time, and heard of late.
        age = seconds / 2 + AGE
        wrong = measured - (motion.depth - motion.speed * age)
        gains, self._covariance = take_in(self._covariance, [1.0, -age, 0.0, 0.0, 0.0, 0.0], noise**2)
        depth, speed, strength, blades, hull, drift = gains
        if measured > _AWASH:
            heave = self.heave
            heave.strength = _within(heave.strength + strength * wrong, *_RANGE)
            heave.blades = _within(heave.blades + blades * wrong, *_RANGE)
            heave.hull = _within(heave.hull + hull * wrong, *_RANGE)
            heave.drift = _within(heave.drift + drift * wrong, -_DRIFT_MAX, _DRIFT_MAX)
        return motion._replace(depth=motion.depth + depth * wrong, speed=motion.speed + speed * wrong)

    def _predict(self, motion: Motion, command: float, seconds: float) -> Motion:
        heave = self.heave
        lag = min(LAG, seconds / 2)
        motion = heave.advance(motion, self._earlier, lag, _STEP)
        first = heave.slopes
        motion = heave.advance(motion, command, seconds - lag, _STEP)
        pushed, paddled, resisted = (a + b for a, b in zip(first[:3], heave.slopes[:3], strict=True))
        retained = first[3] * heave.slopes[3]
        self._earlier = command
        to_speed = [0.0, retained, pushed, paddled, resisted, seconds]
        to_depth = [1.0, seconds * (1 + retained) / 2, *(seconds / 2 * slope for slope in to_speed[2:])]
        speed_noise = _CALM + _PUSHED * abs(pushed) / seconds + _PADDLED * abs(paddled)
        rows = [self._mixed(to_depth), self._mixed(to_speed), *self._covariance[2:]]
        self._covariance = [[dot(to_depth, row), dot(to_speed, row), *row[2:]] for row in rows]
        for place, deviation in enumerate((0.0, speed_noise, *_CHANGE)):
            self._covariance[place][place] += deviation**2
        return motion

    def _mixed(self, shares: list[float]) -> list[float]:
        return [dot(shares, column) for column in zip(*self._covariance, strict=True)]


def _within(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
