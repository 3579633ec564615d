"""The fin check: moves each axis briefly and compares each fin's angle with its set point."""

from collections.abc import Iterable
from math import sqrt, tau
from statistics import fmean

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import FIN_COUNT, Motor, Navigation
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.control.pilot import AXES, NEUTRAL

FINS = ("front right", "back right", "back left", "front left")
_STEP = 1.3
"""s for each axis: one and a half strokes."""
_SHARE = 0.5
_ERROR_MAX = 0.8
"""Largest error of a sound fin, as a share of the least that a fin at rest could have: in a stroke about one
direction, a lag of 47° makes so much."""
_MOTION_MIN = 0.1
"""rad; a fin whose set point deviates less counts as not commanded."""


class FinTracking:
    """Judge of a fin that should follow its set point, by samples of both (rad, -π to π)."""

    def __init__(self) -> None:
        self._samples: list[tuple[float, float]] = []

    def see(self, set_point: float, angle: float) -> None:
        """Take a sample."""
        self._samples.append((set_point, angle))

    def judge(self) -> str:
        """Return the fin's problem as text; empty if it follows."""
        samples = list(self._samples)
        motion = _deviation(set_point for set_point, _ in samples)
        if motion < _MOTION_MIN:
            return "was not moved"
        error = sqrt(fmean(wrap_angle(angle - set_point) ** 2 for set_point, angle in samples))
        if error <= _ERROR_MAX * motion:
            return ""
        if _deviation(angle + set_point for set_point, angle in samples) <= _ERROR_MAX * motion:
            return "turned against its set point"
        return f"was off its set point by {error:.2f} rad"


def _deviation(angles: Iterable[float]) -> float:
    """Return the least root mean square distance (rad) of these angles from any one angle.

    The least of the variances with the circle cut open between any two of them: Hotz and Huckemann,
    Intrinsic means on the circle, 2015. 0 without angles.
    """
    ordered = sorted(map(wrap_angle, angles))
    if not ordered:
        return 0.0
    count, total, squares = len(ordered), sum(ordered), sum(angle * angle for angle in ordered)
    least = squares / count - (total / count) ** 2
    for angle in ordered:
        total += tau
        squares += tau * (2 * angle + tau)
        least = min(least, squares / count - (total / count) ** 2)
    return sqrt(max(least, 0.0))


class FinCheck:
    """The fin check; `step` is called by the control loop, `see` by the receiver of messages."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.begin()

    def begin(self) -> None:
        """Start a new check."""
        self._began = self._clock.now()
        self._fins = [FinTracking() for _ in range(FIN_COUNT)]

    def step(self) -> Navigation | None:
        """Return the present command; None when the check is over.

        It points up, so that the robot does not dive.
        """
        number = int((self._clock.now() - self._began) / _STEP)
        if number >= len(AXES):
            return None
        name = AXES[number]
        axes = {axis: getattr(NEUTRAL, axis) for axis in AXES}
        return Navigation(**axes | {name: -_SHARE if name == "z" else _SHARE})

    def see(self, motor: Motor) -> None:
        """Take the fins' angles and their set points."""
        for fin, set_point, angle in zip(self._fins, motor.wanted, motor.angle, strict=True):
            fin.see(set_point, angle)

    def failed(self) -> dict[str, str]:
        """Return the fins that did not follow, by name, each with its problem."""
        return {name: problem for fin, name in zip(self._fins, FINS, strict=True) if (problem := fin.judge())}
