"""Heading by fins that are tilted a little while they hold the depth."""

from collections.abc import Mapping
from math import asin, cos, tan
from typing import ClassVar

from robot_runtime.control.controllers.base import Controller, GainLimits, Rate, braked

_AMPLITUDE = 1.6
"""rad; of fins at full command. Their thrust is ∝ 1 - cos of it."""
_POINTING = 0.02
"""Command downwards below which the fins do not push but turn round, and so lose their tilt."""
_SHARE_LEAST = 0.04
"""Of the thrust; with less, more tilt would not do."""
_FILTER = 0.2
"""s, time constant of the turn rate."""


class Tilt(Controller):
    """Tilts the fins that push up or down, so that a part of their push turns the hull.

    A yaw command y beside a command z downwards turns each fin's direction by atan(y / |z|). Where z is
    small a small y turns the fins far, and fins that turn are a blow to hull and depth. So this controller
    thinks in the tilt: as much as the wanted acceleration needs with the thrust that there is, never far, and
    slowly; where the fins rest it waits. It is of use only while the depth is steered.

    The wanted turn rate is as braking allows it, √(2·a·angle), linear where that would be too steep, as in
    `Predictive`.
    """

    name = "tilt"
    title = "Tilted fins"
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "tilt": GainLimits(1.0, 0.1, 1.2, "rad", "most by which the fins are tilted"),
        "slew": GainLimits(1.0, 0.1, 5.0, "rad/s", "how fast they are"),
        "response": GainLimits(1.5, 0.2, 10.0, "1/s", "how fast the wanted turn rate is taken up"),
        "approach": GainLimits(0.8, 0.1, 5.0, "1/s", "wanted turn rate for each rad from the set point"),
        "braking": GainLimits(0.15, 0.01, 2.0, "rad/s²", "deceleration that is counted on"),
        "torque": GainLimits(6.8, 0.5, 50.0, "rad/s²", "acceleration by all fins at full command"),
    }

    def __init__(self) -> None:
        super().__init__()
        self.start()

    def start(self) -> None:
        """Forget tilt and turn rate."""
        self._tilt = 0.0
        self._rate = Rate(_FILTER)

    def step(self, set_point: float, measured: float, seconds: float) -> float:
        """The yaw that tilts the fins as they should be."""
        self._rate.see(measured, seconds)
        if abs(self.heave_command) < _POINTING:
            if self.heave_command:
                self._tilt = 0.0
            return 0.0
        most = self.gains["slew"] * seconds
        self._tilt += min(max(self._goal_tilt(set_point - measured) - self._tilt, -most), most)
        return abs(self.heave_command) * tan(self._tilt)

    def _goal_tilt(self, left: float) -> float:
        rate = braked(left, self.gains["braking"], self.gains["approach"])
        share = max((1 - cos(_AMPLITUDE * abs(self.heave_command))) / (1 - cos(_AMPLITUDE)), _SHARE_LEAST)
        part = self.gains["response"] * (rate - self._rate.value) / (self.gains["torque"] * share)
        most = self.gains["tilt"]
        return min(max(asin(min(max(part, -1.0), 1.0)), -most), most)
