"""The runtime's own parameters, with the limits of the contract and of the controllers."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from robot_runtime.contract.limits import SET_POINT, VISION_RATE
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.control.controllers.base import Controller
from robot_runtime.control.loop import ControlLoop
from robot_runtime.control.node import ControlNode
from robot_runtime.control.steering import STEERINGS
from robot_runtime.parameters.board import BoardParameters
from robot_runtime.parameters.entry import Entry
from robot_runtime.parameters.registry import Registry
from robot_runtime.vision.interface import Vision


def make_registry(
    control: ControlNode,
    vision: Vision,
    set_vision: Callable[[VisionSettings], None],
    board: BoardParameters,
    armed: Callable[[], bool],
) -> Registry:
    """Return the registry of all parameters; `set_vision` applies vision settings."""
    entries = [*_runtime_entries(control, vision, set_vision), *board.entries()]
    return Registry(entries, armed=armed, tick_lock=control.tick_lock)


def _runtime_entries(
    control: ControlNode, vision: Vision, set_vision: Callable[[VisionSettings], None]
) -> Iterator[Entry]:
    """Yield every parameter of control node and vision node."""
    yield from _set_points(control)
    yield Entry(
        name="control.steering",
        type="choice",
        get=lambda: control.steering,
        set=control.steer,
        choices=lambda: STEERINGS,
        meaning="course while the robot holds its depth",
    )
    for loop in control.loops.values():
        yield _controller(control, loop)
        for controller in loop.controllers.values():
            yield from _gains(loop.name, controller)
    yield from _vision(vision, set_vision)


def _controller(control: ControlNode, loop: ControlLoop) -> Entry:
    return Entry(
        name=f"{loop.name}.controller",
        type="choice",
        get=lambda: loop.controller.name,
        set=lambda name: control.set_loop(loop.name, controller=name),
        choices=lambda: list(loop.controllers),
        meaning=f"controller of the {loop.name}",
    )


def _set_points(control: ControlNode) -> Iterator[Entry]:
    low, high = SET_POINT.minimum, control.deepest
    yield Entry(
        name="control.set_point",
        get=lambda: control.set_point_default,
        set=lambda depth: control.set_points(depth, control.set_point_detected),
        minimum=low,
        maximum=high,
        unit="m",
        meaning="depth set point",
    )
    yield Entry(
        name="control.set_point_detected",
        get=lambda: control.set_point_detected,
        set=lambda depth: control.set_points(control.set_point_default, depth),
        minimum=low,
        maximum=high,
        unit="m",
        meaning="depth set point while the colour is seen",
    )


def _gains(loop: str, controller: Controller) -> Iterator[Entry]:
    for name, gain in controller.limits.items():
        yield Entry(
            name=f"{loop}.{controller.name}.{name}",
            get=partial(_gain, controller, name),
            set=partial(_tune, controller, name),
            minimum=gain.minimum,
            maximum=gain.maximum,
            unit=gain.unit,
            meaning=gain.meaning,
        )


def _gain(controller: Controller, name: str) -> float:
    return controller.gains[name]


def _tune(controller: Controller, name: str, value: float) -> None:
    controller.tune({name: value})


def _vision(vision: Vision, set_vision: Callable[[VisionSettings], None]) -> Iterator[Entry]:
    def set_rate(rate: float) -> None:
        set_vision(replace(vision.settings, rate=rate))

    def set_colour(colour: str) -> None:
        set_vision(replace(vision.settings, colour=colour))

    yield Entry(
        name="vision.rate",
        get=lambda: vision.settings.rate,
        set=set_rate,
        minimum=VISION_RATE.minimum,
        maximum=VISION_RATE.maximum,
        unit="Hz",
        meaning="rate of the vision node",
    )
    yield Entry(
        name="vision.colour",
        type="choice",
        get=lambda: vision.settings.colour,
        set=set_colour,
        choices=lambda: list(vision.settings.colours),
        meaning="the colour that changes the set point",
    )
