"""The runtime's own parameters, each with its range from where that stands anyway."""

from collections.abc import Iterator
from functools import partial

from robot_runtime.config import SET_POINT, VISION_RATE, VisionConfig, limits
from robot_runtime.control.controllers import Controller
from robot_runtime.control.node import ControlNode
from robot_runtime.control.steering import STEERINGS
from robot_runtime.parameters.entry import Entry
from robot_runtime.vision.node import Vision


def runtime_entries(control: ControlNode, vision: Vision) -> Iterator[Entry]:
    """Every parameter of the control node and of the vision node."""
    yield from _set_points(control)
    yield Entry(
        name="control.steering",
        type="choice",
        get=lambda: control.steering,
        set=control.steer,
        choices=lambda: STEERINGS,
        meaning="where it swims while it holds its depth",
    )
    yield Entry(
        name="depth.controller",
        type="choice",
        get=lambda: control.controller.name,
        set=control.choose,
        choices=lambda: list(control.controllers),
        meaning="what steers the depth",
    )
    for controller in control.controllers.values():
        yield from _gains("depth", controller)
    yield from _vision(control, vision)


def _set_points(control: ControlNode) -> Iterator[Entry]:
    low, high = SET_POINT.minimum, SET_POINT.maximum
    yield Entry(
        name="control.set_point",
        get=lambda: control.set_point_default,
        set=lambda depth: control.set_points(depth, control.set_point_detected),
        minimum=low,
        maximum=high,
        unit="m",
        meaning="wanted depth",
    )
    yield Entry(
        name="control.set_point_detected",
        get=lambda: control.set_point_detected,
        set=lambda depth: control.set_points(control.set_point_default, depth),
        minimum=low,
        maximum=high,
        unit="m",
        meaning="wanted depth while the colour is seen",
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


def _vision(control: ControlNode, vision: Vision) -> Iterator[Entry]:
    def choose(colour: str) -> None:
        vision.colour = control.colour = colour

    def look(rate: float) -> None:
        vision.rate = rate

    def ask(share: float) -> None:
        vision.area_min = share

    area = limits(VisionConfig, "area_min")
    yield Entry(
        name="vision.rate",
        get=lambda: vision.rate,
        set=look,
        minimum=VISION_RATE.minimum,
        maximum=VISION_RATE.maximum,
        unit="Hz",
        meaning="how often the vision node looks",
    )
    yield Entry(
        name="vision.colour",
        type="choice",
        get=lambda: vision.colour,
        set=choose,
        choices=lambda: list(vision.colours),
        meaning="the colour that changes the set point",
    )
    yield Entry(
        name="vision.area_min",
        get=lambda: vision.area_min,
        set=ask,
        minimum=area.minimum,
        maximum=area.maximum,
        meaning="share of the picture that must have the colour",
    )
