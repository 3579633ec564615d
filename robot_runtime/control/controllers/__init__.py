"""The controllers of each loop, the first of which it begins with."""

from robot_runtime.control.controllers.angle import HeadingPid, PitchPid, RollPid, TurnDeadZone
from robot_runtime.control.controllers.bang_bang import BangBang, BangBangDeadZone
from robot_runtime.control.controllers.base import Controller, GainLimits
from robot_runtime.control.controllers.pid import Pid
from robot_runtime.control.controllers.predictive import Predictive
from robot_runtime.control.controllers.tilt import Tilt

__all__ = [
    "CONTROLLERS",
    "BangBang",
    "BangBangDeadZone",
    "Controller",
    "GainLimits",
    "Pid",
    "Predictive",
    "Tilt",
]

CONTROLLERS: dict[str, tuple[type[Controller], ...]] = {
    "depth": (BangBang, BangBangDeadZone, Pid, Predictive),
    "heading": (HeadingPid, TurnDeadZone, Tilt),
    "pitch": (PitchPid,),
    "roll": (RollPid,),
}
"""By the loop's name."""
