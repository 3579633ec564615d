"""The controllers of each loop; the first is the default."""

from collections.abc import Mapping

from robot_runtime.config import ControlConfig
from robot_runtime.contract.limits import ConfigError
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


def check_controller(loop: str, name: str, gains: Mapping[str, Mapping[str, float]]) -> None:
    """Raise ValueError where the loop has no such controller, or gains are unknown or out of range."""
    controllers = {controller.name: controller for controller in CONTROLLERS[loop]}
    for required in (name, *gains):
        if required not in controllers:
            raise ValueError(f"there is no controller {required!r}; there are {', '.join(controllers)}")
    for tuned, numbers in gains.items():
        controllers[tuned].check(numbers)


def check_control(config: ControlConfig) -> None:
    """Raise ConfigError where the depth loop has no such controller, or not such gains."""
    try:
        check_controller("depth", config.controller, config.gains)
    except ValueError as problem:
        raise ConfigError(f"control: {problem}") from problem
