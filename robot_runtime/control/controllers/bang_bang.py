"""Bang-bang controllers: the thesis's, and those with a dead zone."""

import math
from collections.abc import Mapping
from typing import ClassVar

from robot_runtime.control.controllers.base import Controller, GainLimits

_OUTPUT = GainLimits(1.0, 0.0, 1.0, "", "size of the command, as a share of the most")


class BangBang(Controller):
    """Always full command towards the set point, as in the thesis."""

    name = "bang_bang"
    title = "Bang-bang"
    limits: ClassVar[Mapping[str, GainLimits]] = {"output": _OUTPUT}

    def step(self, set_point: float, measured: float, seconds: float) -> float:  # noqa: ARG002
        """Return the full command with the sign of the error."""
        error = set_point - measured
        return math.copysign(self.gains["output"], error) if error else 0.0


class BangBangDeadZone(Controller):
    """Bang-bang with no command near the set point."""

    name = "bang_bang_dead_zone"
    title = "Bang-bang with dead zone"
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "output": _OUTPUT,
        "dead_zone": GainLimits(0.05, 0.0, 1.0, "m", "no command within this distance of the set point"),
    }

    def step(self, set_point: float, measured: float, seconds: float) -> float:  # noqa: ARG002
        """Return the full command with the sign of the error outside the dead zone, 0 inside."""
        error = set_point - measured
        return math.copysign(self.gains["output"], error) if abs(error) > self.gains["dead_zone"] else 0.0


class TurnDeadZone(BangBangDeadZone):
    """Bang-bang with dead zone for an angle."""

    limits: ClassVar[Mapping[str, GainLimits]] = {
        "output": GainLimits(0.3, 0.0, 1.0, "", "size of the command, as a share of the most"),
        "dead_zone": GainLimits(0.1, 0.0, 1.0, "rad", "no command within this angle of the set point"),
    }
