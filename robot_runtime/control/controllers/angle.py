"""Controllers of heading, pitch and roll: those of the depth with gains of their own, in rad."""

from collections.abc import Mapping
from typing import ClassVar

from robot_runtime.control.controllers.bang_bang import BangBangDeadZone
from robot_runtime.control.controllers.base import GainLimits
from robot_runtime.control.controllers.pid import Pid


def _pid_limits(kp: float, ki: float, kd: float) -> Mapping[str, GainLimits]:
    return {
        "kp": GainLimits(kp, 0.0, 20.0, "1/rad", "command for each rad of error"),
        "ki": GainLimits(ki, 0.0, 20.0, "1/(rad s)", "command for each rad of error and second"),
        "kd": GainLimits(kd, 0.0, 20.0, "s/rad", "command against each rad/s of turning"),
    }


class HeadingPid(Pid):
    """Nothing but water holds the heading."""

    limits: ClassVar[Mapping[str, GainLimits]] = _pid_limits(0.3, 0.0, 0.3)


class PitchPid(Pid):
    """Buoyancy rights the hull, faster than the fins turn round: only the integral is of use."""

    limits: ClassVar[Mapping[str, GainLimits]] = _pid_limits(0.0, 0.8, 0.0)


class RollPid(Pid):
    """As `PitchPid`."""

    limits: ClassVar[Mapping[str, GainLimits]] = _pid_limits(0.0, 0.8, 0.0)


class TurnDeadZone(BangBangDeadZone):
    """Bang-bang with dead zone for an angle."""

    limits: ClassVar[Mapping[str, GainLimits]] = {
        "output": GainLimits(0.3, 0.0, 1.0, "", "size of the command, as a share of the most"),
        "dead_zone": GainLimits(0.1, 0.0, 1.0, "rad", "no command within this angle of the set point"),
    }
