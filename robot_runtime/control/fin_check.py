"""The fin check: moves each axis briefly and compares each fin's angle with its set point."""

from math import sqrt
from statistics import fmean, linear_regression, pstdev

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import FIN_COUNT, Motor, Navigation
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.control.pilot import AXES, NEUTRAL

FINS = ("front right", "back right", "back left", "front left")
_STEP = 1.3
"""s for each axis: one and a half strokes."""
_SHARE = 0.5
_ERROR_MAX = 0.8
"""Largest error of a sound fin as a share of its set point's motion, both as standard deviations: a lag of
47° of its stroke makes so much."""
_SWING_MIN = 0.2
"""rad; with less commanded swing, the fin counts as not commanded."""


class FinTracking:
    """Judges whether a fin follows its set point, by samples of both (rad, -π to π)."""

    def __init__(self) -> None:
        self._unwrapped = 0.0
        self._set_points: list[float] = []
        self._errors: list[float] = []

    def see(self, set_point: float, angle: float) -> None:
        """Takes a sample."""
        self._unwrapped += wrap_angle(set_point - self._unwrapped)
        self._set_points.append(self._unwrapped)
        self._errors.append(wrap_angle(angle - set_point))

    def judge(self) -> str:
        """Returns what is wrong with the fin; empty if it follows."""
        if not self._set_points or max(self._set_points) - min(self._set_points) < _SWING_MIN:
            return "was not moved"
        error = sqrt(fmean(one * one for one in self._errors))
        if error <= _ERROR_MAX * pstdev(self._set_points):
            return ""
        # The slope of the angle over the set point is 1 + this; it is -1 where the fin is mirrored.
        slope = linear_regression(self._set_points, self._errors).slope
        return "turned against its set point" if slope < -1.2 else f"was off its set point by {error:.2f} rad"


class FinCheck:
    """Runs fin checks; `step` is called by the control loop, `see` by the receiver of messages."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.begin()

    def begin(self) -> None:
        """Starts a new check."""
        self._began = self._clock.now()
        self._fins = [FinTracking() for _ in range(FIN_COUNT)]

    def step(self) -> Navigation | None:
        """Returns the present command; None when the check is over. It swims up, so as not to dive."""
        number = int((self._clock.now() - self._began) / _STEP)
        if number >= len(AXES):
            return None
        name = AXES[number]
        axes = {one: getattr(NEUTRAL, one) for one in AXES}
        return Navigation(**axes | {name: -_SHARE if name == "z" else _SHARE})

    def see(self, motor: Motor) -> None:
        """Takes the fins' angles and their set points."""
        for fin, set_point, angle in zip(self._fins, motor.wanted, motor.angle, strict=True):
            fin.see(set_point, angle)

    def failed(self) -> dict[str, str]:
        """Returns the fins that did not follow, by name, with what they did."""
        return {name: words for fin, name in zip(self._fins, FINS, strict=True) if (words := fin.judge())}
