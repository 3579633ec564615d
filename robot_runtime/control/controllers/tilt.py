"""Control of the heading by tilting the fins that hold the depth."""

from collections.abc import Mapping
from math import asin, cos, tan
from typing import ClassVar

from robot_runtime.control.controllers.base import Controller, GainLimits, Rate, braking_speed

_AMPLITUDE = 1.6
"""rad; of fins at full command. Their thrust is ∝ 1 - cos of it."""
_POINTING = 0.02
"""Least command downwards at which the fins push; below it they turn round and lose their tilt."""
_SHARE_LEAST = 0.04
"""Least share of the thrust that is counted on; below it, more tilt has no effect."""
_FILTER = 0.2
"""s, time constant of the turn rate."""


class Tilt(Controller):
    """Tilts the fins that push up or down, so that a part of their push turns the hull.

    A yaw command y beside a command z downwards turns each fin's direction by atan(y / |z|). Where z is
    small a small y turns the fins far, and turning fins disturb hull and depth. So this controller computes
    the tilt: what the required acceleration needs with the present thrust, limited in size and rate. While
    the fins rest it waits. It works only while the depth is controlled.

    The goal of the turn rate is `braking_speed` of the angle.
    """

    name = "tilt"
    title = "Tilted fins"
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "tilt": GainLimits(1.0, 0.1, 1.2, "rad", "most by which the fins are tilted"),
        "slew": GainLimits(1.0, 0.1, 5.0, "rad/s", "how fast they are tilted"),
        "response": GainLimits(1.5, 0.2, 10.0, "1/s", "how fast the turn rate approaches its goal"),
        "approach": GainLimits(0.8, 0.1, 5.0, "1/s", "turn rate for each rad from the set point"),
        "braking": GainLimits(0.15, 0.01, 2.0, "rad/s²", "deceleration assumed for braking"),
        "torque": GainLimits(6.8, 0.5, 50.0, "rad/s²", "acceleration by all fins at full command"),
    }

    def __init__(self) -> None:
        super().__init__()
        self.start()

    def start(self) -> None:
        """Reset tilt and turn rate."""
        self._tilt = 0.0
        self._rate = Rate(_FILTER)

    def step(self, set_point: float, measured: float, seconds: float) -> float:
        """Return the yaw command that gives the fins their goal tilt."""
        self._rate.update(measured, seconds)
        if abs(self.heave_command) < _POINTING:
            if self.heave_command:
                self._tilt = 0.0
            return 0.0
        most = self.gains["slew"] * seconds
        self._tilt += min(max(self._goal_tilt(set_point - measured) - self._tilt, -most), most)
        return abs(self.heave_command) * tan(self._tilt)

    def _goal_tilt(self, error: float) -> float:
        rate = braking_speed(error, self.gains["braking"], self.gains["approach"])
        share = max((1 - cos(_AMPLITUDE * abs(self.heave_command))) / (1 - cos(_AMPLITUDE)), _SHARE_LEAST)
        part = self.gains["response"] * (rate - self._rate.value) / (self.gains["torque"] * share)
        most = self.gains["tilt"]
        return min(max(asin(min(max(part, -1.0), 1.0)), -most), most)
