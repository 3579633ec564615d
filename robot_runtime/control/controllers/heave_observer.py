"""Two Kalman filters of depth and speed: one learns the `Heave` model, one uses the accelerometer."""

from collections import deque
from collections.abc import Iterator, Sequence
from operator import mul

from robot_runtime.control.controllers.heave import Heave, Motion

Matrix = list[list[float]]

LAG = 0.05
"""s from a command until the water has answered the fins; likewise the next two, by default."""
AGE = 0.033
"""s by which a reading of the depth is older than the tick that uses it."""
ACCELERATION_AGE = 0.012
"""s by which an acceleration is older than the tick that uses it."""
_STEP = 0.02
"""s of the model's steps."""
_AWASH = 0.008
"""m of depth above which waves and the surface act on the hull, so that nothing is learnt."""
_DEPTH, _SPEED = 0.003, 0.01
"""m, m/s: standard deviations at the start; the next line has those of the parameters."""
_MASS, _STRENGTH, _BLADES, _HULL, _DRIFT = 0.15, 0.3, 0.05, 0.3, 0.006
_CALM, _PUSHED, _PADDLED = 0.001, 0.02, 0.15
"""Errors of the predicted speed of a step: m/s in general; for each m/s² of push, which comes in strokes; as
a share of the blades' effect."""
_CHANGE = (0.002, 0.002, 0.002, 0.0002)
"""Change of the parameters in a step."""
_RANGE = (0.5, 1.6)
"""Limits of the three shares."""
_DRIFT_MAX, _DRIFT_SHARE, _DRIFT_TIMES = 0.03, 0.6, 3.0
"""m/s²; and the drift's standard deviation and limit as shares of the first one, where they are larger."""
_BIAS = 0.1
"""m/s²: standard deviation of the accelerometer's offset at the start."""
_NOISE, _WANDER = 0.012, 0.0005
"""m/s²: noise of the mean acceleration of a step; change of the offset in a step."""


def dot(vector: Sequence[float], other: Sequence[float]) -> float:
    """Return the scalar product of two vectors of the same length."""
    return sum(map(mul, vector, other), start=0.0)


def update(covariance: Matrix, row: Sequence[float], variance: float) -> tuple[list[float], Matrix]:
    """Return the gains for a scalar measurement of `row` times the state, and the covariance after it.

    The caller adds to each state its gain times the innovation (A. Gelb, Applied Optimal Estimation, 1974,
    table 4.2-1).
    """
    towards = [dot(line, row) for line in covariance]
    total = dot(towards, row) + variance
    gains = [value / total for value in towards]
    after = [
        [old - gain * value for old, value in zip(line, towards, strict=True)]
        for line, gain in zip(covariance, gains, strict=True)
    ]
    return gains, after


class HeaveObserver:
    """An extended Kalman filter of depth, speed and four parameters of `heave`, the model that it corrects.

    No reading shows these by itself: the strength of the fins, the resistance of blades and hull, and the
    drift (augmented state, A. Gelb, Applied Optimal Estimation, 1974, 9.4). The initial covariance couples
    the first three, as another mass changes them together.
    """

    def __init__(self, heave: Heave) -> None:
        self.heave = heave
        self.lag, self.age = LAG, AGE
        self._acting = 0.0
        self._pending: deque[tuple[float, float]] = deque()
        """Commands that do not act yet: s until they do, and the command."""
        drift = max(_DRIFT, _DRIFT_SHARE * abs(heave.drift))
        self._drift_max = max(_DRIFT_MAX, _DRIFT_TIMES * abs(heave.drift))
        common = _MASS**2
        self._covariance: Matrix = [
            [_DEPTH**2, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, _SPEED**2, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, common + _STRENGTH**2, common, common, 0.0],
            [0.0, 0.0, common, common + _BLADES**2, common, 0.0],
            [0.0, 0.0, common, common, common + _HULL**2, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, drift**2],
        ]

    def observe(
        self, motion: Motion, command: float, measured: float, noise: float, seconds: float
    ) -> Motion:
        """Return the motion now from the motion `seconds` ago, the command and the mean measured depth since.

        `noise` is the standard deviation of that mean, m.
        """
        motion = self._predict(motion, command, seconds)
        # The mean belongs to the middle of the time, and arrives late.
        age = seconds / 2 + self.age
        innovation = measured - (motion.depth - motion.speed * age)
        gains, self._covariance = update(self._covariance, [1.0, -age, 0.0, 0.0, 0.0, 0.0], noise**2)
        depth, speed, strength, blades, hull, drift = gains
        if measured > _AWASH:
            heave = self.heave
            heave.strength = _clamp(heave.strength + strength * innovation, *_RANGE)
            heave.blades = _clamp(heave.blades + blades * innovation, *_RANGE)
            heave.hull = _clamp(heave.hull + hull * innovation, *_RANGE)
            heave.drift = _clamp(heave.drift + drift * innovation, -self._drift_max, self._drift_max)
        return motion._replace(
            depth=motion.depth + depth * innovation, speed=motion.speed + speed * innovation
        )

    def _predict(self, motion: Motion, command: float, seconds: float) -> Motion:
        heave = self.heave
        pushed = paddled = resisted = 0.0
        retained = 1.0
        self._pending.append((self.lag, command))
        for acting, duration in self._acting_for(seconds):
            motion = heave.advance(motion, acting, duration, _STEP)
            push, paddle, resistance, share = heave.slopes
            pushed, paddled, resisted = pushed + push, paddled + paddle, resisted + resistance
            retained *= share
        while self._pending and self._pending[0][0] <= seconds:
            self._acting = self._pending.popleft()[1]
        self._pending = deque((until - seconds, command) for until, command in self._pending)
        to_speed = [0.0, retained, pushed, paddled, resisted, seconds]
        to_depth = [1.0, seconds * (1 + retained) / 2, *(seconds / 2 * slope for slope in to_speed[2:])]
        speed_noise = _CALM + _PUSHED * abs(pushed) / seconds + _PADDLED * abs(paddled)
        rows = [self._propagate(to_depth), self._propagate(to_speed), *self._covariance[2:]]
        self._covariance = [[dot(to_depth, row), dot(to_speed, row), *row[2:]] for row in rows]
        for index, deviation in enumerate((0.0, speed_noise, *_CHANGE)):
            self._covariance[index][index] += deviation**2
        return motion

    def lead(self, motion: Motion, step: float) -> Motion:
        """Return the motion at which a command of now will act; `motion` is that of now, `step` is in s."""
        for acting, duration in self._acting_for(self.lag):
            motion = self.heave.advance(motion, acting, duration, step)
        return motion

    def _acting_for(self, seconds: float) -> Iterator[tuple[float, float]]:
        """Yield each command that acts during the next `seconds`, and its duration (s)."""
        acting, since = self._acting, 0.0
        for until, command in self._pending:
            if until >= seconds:
                break
            if until > since:
                yield acting, until - since
            acting, since = command, until
        if seconds > since:
            yield acting, seconds - since

    def _propagate(self, shares: list[float]) -> list[float]:
        return [dot(shares, column) for column in zip(*self._covariance, strict=True)]


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


class InertialHeave:
    """A Kalman filter of depth and speed from accelerometer and pressure, without a model of the craft.

    It begins at a depth (m) and a speed (m/s, downwards). An accelerometer shows every stroke of the fins,
    which no model does, but with an offset. The depth reveals that offset in the long run, so that it is a
    third state (J. A. Farrell, Aided Navigation, 2008, 4.6).
    """

    def __init__(self, depth: float, speed: float) -> None:
        self.age, self.acceleration_age = AGE, ACCELERATION_AGE
        self._depth, self._speed, self._bias = depth, speed, 0.0
        self._covariance: Matrix = [[_DEPTH**2, 0.0, 0.0], [0.0, _SPEED**2, 0.0], [0.0, 0.0, _BIAS**2]]

    def observe(
        self, acceleration: float, measured: float, noise: float, seconds: float
    ) -> tuple[float, float]:
        """Return depth and speed now from the mean acceleration (m/s²) and depth (m) since the last call.

        `noise` is the standard deviation of that depth, m.
        """
        self._predict(acceleration, seconds)
        # The mean belongs to the middle of the time.
        row = [1.0, -(seconds / 2 + self.age - self.acceleration_age), 0.0]
        innovation = measured - dot(row, [self._depth, self._speed, self._bias])
        (depth, speed, bias), self._covariance = update(self._covariance, row, noise**2)
        self._depth += depth * innovation
        self._speed += speed * innovation
        self._bias += bias * innovation
        now = self._speed + (acceleration - self._bias) * self.acceleration_age
        return self._depth + now * self.acceleration_age, now

    def _predict(self, acceleration: float, seconds: float) -> None:
        gained = (acceleration - self._bias) * seconds
        self._depth += (self._speed + gained / 2) * seconds
        self._speed += gained
        change = [1.0, seconds, -(seconds**2) / 2], [0.0, 1.0, -seconds], [0.0, 0.0, 1.0]
        half = [[dot(row, column) for column in zip(*self._covariance, strict=True)] for row in change]
        self._covariance = [[dot(line, row) for row in change] for line in half]
        for index, deviation in enumerate((0.0, _NOISE * seconds, _WANDER)):
            self._covariance[index][index] += deviation**2
