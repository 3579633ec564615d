"""The controllers of each loop; the first is the default."""

from robot_runtime.control.controllers.bang_bang import BangBang, BangBangDeadZone, TurnDeadZone
from robot_runtime.control.controllers.base import Controller
from robot_runtime.control.controllers.pid import HeadingPid, Pid, PitchPid, RollPid
from robot_runtime.control.controllers.predictive import Predictive
from robot_runtime.control.controllers.tilt import Tilt

CONTROLLERS: dict[str, tuple[type[Controller], ...]] = {
    "depth": (BangBang, BangBangDeadZone, Pid, Predictive),
    "heading": (HeadingPid, TurnDeadZone, Tilt),
    "pitch": (PitchPid,),
    "roll": (RollPid,),
}
"""By the loop's name."""
