"""What the other processes may ask of the robot: each command is checked here, then done or refused."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from robot_runtime.control.supervisor import ALONE_MAX
from robot_runtime.core import Core
from robot_runtime.errors import Refused
from robot_runtime.samples import Mode


class Commands:
    """Every command to one robot; `do` has what each name does with its arguments, or raises Refused."""

    def __init__(self, robot: Core) -> None:
        self._robot = robot
        handlers: dict[str, Callable[[Mapping[str, Any]], None]] = {
            "stop": self._stop,
            "arm": self._arm,
            "mode": self._mode,
            "check_fins": self._check_fins,
            "acknowledge": self._acknowledge,
            "lease": self._lease,
            "controller": self._controller,
            "loop": self._loop,
            "set_points": self._set_points,
            "steering": self._steering,
            "card": self._card,
            "vision": self._vision,
        }
        self.do = {name: self._announcing(handler) for name, handler in handlers.items()}

    def _announcing(
        self, handler: Callable[[Mapping[str, Any]], None]
    ) -> Callable[[Mapping[str, Any]], None]:
        def handle(question: Mapping[str, Any]) -> None:
            handler(question)
            self._robot.announce()

        return handle

    def _stop(self, _: Mapping[str, Any]) -> None:
        self._robot.supervisor.stop("Stopped by the operator.")

    def _arm(self, question: Mapping[str, Any]) -> None:
        mode, alone = read_arming(question)
        self._robot.supervisor.arm(mode, alone)

    def _mode(self, question: Mapping[str, Any]) -> None:
        self._robot.supervisor.change_mode(_mode(question))

    def _check_fins(self, _: Mapping[str, Any]) -> None:
        self._robot.supervisor.arm("test")

    def _acknowledge(self, _: Mapping[str, Any]) -> None:
        self._robot.supervisor.acknowledge()

    def _lease(self, question: Mapping[str, Any]) -> None:
        epoch = question.get("epoch")
        if type(epoch) is not int:
            raise Refused(f"epoch is {epoch!r}; it must be a whole number")
        self._robot.supervisor.pilot.change_lease(epoch)

    def _controller(self, question: Mapping[str, Any]) -> None:
        self._robot.control.choose(_text(question, "name"), _gains(question))

    def _loop(self, question: Mapping[str, Any]) -> None:
        name, on = _text(question, "name"), question.get("on")
        if on is not None and not isinstance(on, bool):
            raise Refused(f"on is {on!r}; it must be true or false")
        if on and name == "depth" and (reasons := self._robot.supervisor.watch.depth_refusals()):
            raise Refused(" ".join(reasons))
        self._robot.control.set_loop(
            name,
            on=on,
            set_point=None if question.get("set_point") is None else _number(question, "set_point", 0.0),
            controller=None if question.get("controller") is None else _text(question, "controller"),
            gains=_gains(question),
        )

    def _set_points(self, question: Mapping[str, Any]) -> None:
        control = self._robot.control
        default = _number(question, "default", control.set_point_default)
        control.set_points(default, _number(question, "detected", control.set_point_detected))

    def _steering(self, question: Mapping[str, Any]) -> None:
        self._robot.control.steer(_text(question, "by"))

    def _card(self, question: Mapping[str, Any]) -> None:
        self._robot.vision.show_card(None if question.get("colour") is None else _text(question, "colour"))

    def _vision(self, question: Mapping[str, Any]) -> None:
        rate = _number(question, "rate", self._robot.vision.rate)
        colour = question.get("colour") or self._robot.control.colour
        if colour not in self._robot.vision.colours:
            raise Refused(f"no colour is named {colour!r}; there are {', '.join(self._robot.vision.colours)}")
        self._robot.vision.rate = rate
        self._robot.vision.colour = self._robot.control.colour = colour


def read_arming(question: Mapping[str, Any]) -> tuple[Mode, float]:
    """How the robot is to be armed, and for how many s it may go on without the server. Raises Refused."""
    alone = _number(question, "alone", 0.0)
    if not 0 <= alone <= ALONE_MAX:
        raise Refused(f"alone is {alone:g} s; it must lie between 0 and {ALONE_MAX:g}")
    return _mode(question) if "mode" in question else "automatic", alone


def _mode(question: Mapping[str, Any]) -> Mode:
    modes: dict[Any, Mode] = {"automatic": "automatic", "manual": "manual"}
    mode = _text(question, "mode")
    if mode not in modes:
        raise Refused(f"mode is {mode!r}; it must be automatic or manual")
    return modes[mode]


def _gains(question: Mapping[str, Any]) -> dict[str, Any]:
    gains = question.get("gains") or {}
    if not isinstance(gains, dict):
        raise Refused("gains must be numbers by name")
    return gains


def _text(question: Mapping[str, Any], name: str) -> str:
    value = question.get(name)
    if not isinstance(value, str):
        raise Refused(f"{name} is missing or no text")
    return value


def _number(question: Mapping[str, Any], name: str, default: float) -> float:
    value = question.get(name)
    if value is None:
        return default
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise Refused(f"{name} is {value!r}; it must be a number")
    return float(value)
