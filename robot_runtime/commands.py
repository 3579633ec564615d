"""Commands of other processes to the robot: each is checked here, then executed or refused."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from robot_runtime.contract.documents import Mode
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.control.experiment_request import read_experiment
from robot_runtime.control.supervisor import ALONE_MAX
from robot_runtime.core import Core
from robot_runtime.errors import RefusedError

CHANGING = ("controller", "loop", "parameters", "set_points", "steering")
"""What would change under an experiment what it measures."""

Command = Callable[[Mapping[str, Any]], Mapping[str, Any] | None]


class Commands:
    """Every command to one robot; `do` has what each name does with its arguments, or raises RefusedError."""

    def __init__(self, robot: Core) -> None:
        self._robot = robot
        plain: dict[str, Command] = {
            "stop": self._stop,
            "arm": self._arm,
            "mode": self._mode,
            "check_fins": self._check_fins,
            "acknowledge": self._acknowledge,
            "lease": self._lease,
            "card": self._card,
        }
        tuning: dict[str, Command] = {
            "parameters": self._parameters,
            "controller": self._controller,
            "loop": self._loop,
            "set_points": self._set_points,
            "steering": self._steering,
            "vision": self._vision,
            "experiment": self._experiment,
            "end_experiment": self._end_experiment,
            "vision_settings": self._vision_settings,
        }
        for name in CHANGING:
            tuning[name] = self._without_experiment(tuning[name])
        self.do: dict[str, Command] = {name: self._announcing(handler) for name, handler in plain.items()}
        self.do |= {name: self._tuning(handler) for name, handler in tuning.items()}

    def _announcing(self, handler: Command) -> Command:
        def handle(question: Mapping[str, Any]) -> None:
            handler(question)
            self._robot.announce()

        return handle

    def _without_experiment(self, handler: Command) -> Command:
        def handle(question: Mapping[str, Any]) -> Mapping[str, Any] | None:
            self._robot.experiments.require_none()
            return handler(question)

        return handle

    def _tuning(self, handler: Command) -> Command:
        """Wraps a command that changes parameters: it runs between two ticks and returns the changes."""

        def handle(question: Mapping[str, Any]) -> Mapping[str, Any]:
            with self._robot.parameters.changing() as changed:
                answer = handler(question) or {}
            self._robot.announce()
            return {"changed": {name: list(values) for name, values in changed.items()}, **answer}

        return handle

    def _parameters(self, question: Mapping[str, Any]) -> Mapping[str, Any]:
        values, expected = question.get("values"), question.get("expected", {})
        partly = question.get("partly", False)
        if not isinstance(values, dict) or not isinstance(expected, dict) or not isinstance(partly, bool):
            raise RefusedError(
                "values and expected must be values by parameters' names, partly true or false"
            )
        left_out = self._robot.parameters.apply(values, expected, partly=partly)
        return {"left_out": left_out}

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
            raise RefusedError(f"epoch is {epoch!r}; it must be a whole number")
        self._robot.supervisor.pilot.change_lease(epoch)

    def _controller(self, question: Mapping[str, Any]) -> None:
        self._robot.control.choose(_text(question, "name"), _gains(question))

    def _loop(self, question: Mapping[str, Any]) -> None:
        name, on = _text(question, "name"), question.get("on")
        if on is not None and not isinstance(on, bool):
            raise RefusedError(f"on is {on!r}; it must be true or false")
        if on and name == "depth" and (reasons := self._robot.supervisor.detector.depth_refusals()):
            raise RefusedError(" ".join(reasons))
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
        changes = {name: question[name] for name in ("rate", "colour") if question.get(name) is not None}
        self._robot.set_vision(parse(VisionSettings, {**self._robot.vision.settings.table(), **changes}))

    def _vision_settings(self, question: Mapping[str, Any]) -> None:
        self._robot.set_vision(parse(VisionSettings, question))

    def _experiment(self, question: Mapping[str, Any]) -> None:
        mode = self._robot.supervisor.mode
        if mode != "automatic":
            raise RefusedError(f"The robot is {mode}. An experiment needs it armed, in automatic.")
        control, clock = self._robot.control, self._robot.clock
        number, loop, experiment = read_experiment(question, control.loops, clock)
        if loop is control.heading and control.steering == "beacons":
            raise RefusedError("The heading follows the beacons. Choose the course “stay” first.")
        if loop.measured is None:
            raise RefusedError(f"Nothing is known of the {loop.name} yet. Look at the sensors.")
        self._robot.experiments.begin(number, loop, experiment)

    def _end_experiment(self, _: Mapping[str, Any]) -> None:
        self._robot.experiments.stop("It was stopped.")


def read_arming(question: Mapping[str, Any]) -> tuple[Mode, float]:
    """Returns the mode to arm in, and the s for which the robot may go on without the server.

    Raises RefusedError.
    """
    alone = _number(question, "alone", 0.0)
    if not 0 <= alone <= ALONE_MAX:
        raise RefusedError(f"alone is {alone:g} s; it must lie between 0 and {ALONE_MAX:g}")
    return _mode(question) if "mode" in question else "automatic", alone


def _mode(question: Mapping[str, Any]) -> Mode:
    modes: dict[Any, Mode] = {"automatic": "automatic", "manual": "manual"}
    mode = _text(question, "mode")
    if mode not in modes:
        raise RefusedError(f"mode is {mode!r}; it must be automatic or manual")
    return modes[mode]


def _gains(question: Mapping[str, Any]) -> dict[str, Any]:
    gains = question.get("gains") or {}
    if not isinstance(gains, dict):
        raise RefusedError("gains must be numbers by name")
    return gains


def _text(question: Mapping[str, Any], name: str) -> str:
    value = question.get(name)
    if not isinstance(value, str):
        raise RefusedError(f"{name} is missing or no text")
    return value


def _number(question: Mapping[str, Any], name: str, default: float) -> float:
    value = question.get(name)
    if value is None:
        return default
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise RefusedError(f"{name} is {value!r}; it must be a number")
    return float(value)
