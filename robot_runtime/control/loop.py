"""A control loop: one axis, its measured value, set point and controllers."""

from dataclasses import dataclass
from math import degrees
from typing import Literal

from robot_runtime.contract.limits import SET_POINTS, LoopName
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.controllers.base import Controller
from robot_runtime.errors import RefusedError

Axis = Literal["z", "yaw", "pitch", "roll"]


@dataclass(frozen=True, slots=True)
class LoopOverride:
    """A controller and a set point that replace the loop's own; None: the loop's own stays."""

    controller: Controller | None = None
    set_point: float | None = None


class ControlLoop:
    """The control of one `axis` of the navigation command by one measured value, m or rad.

    No set point of the depth in force lies below its `limits`, not even an override's.

    `override` replaces its controller, its set point or both during an experiment or a mission, even while
    it is off.
    Each attribute may be set from any thread; the next tick uses it.
    """

    def __init__(self, name: LoopName, axis: Axis) -> None:
        self.name: LoopName = name
        self.title = name.capitalize()
        self.axis: Axis = axis
        self.limits = SET_POINTS[name]
        self.controllers = {cls.name: cls() for cls in CONTROLLERS[name]}
        self.controller = next(iter(self.controllers.values()))
        self.on = False
        self.set_point = 0.0
        self.override: LoopOverride | None = None
        self.measured: float | None = None
        self.mean: float | None = None
        """Mean of the values measured since the last tick, if there were any."""
        self.heave_acceleration: float | None = None
        """Depth loop only: mean heave acceleration since the last tick, m/s², downwards, if its controller
        `needs_heave_acceleration` and any was measured."""
        self.output: float | None = None
        """The newest command, -1 to 1; None while the loop does not steer."""
        self._is_angle = name != "depth"
        self._running: Controller | None = None
        self._unwrapped = 0.0

    @property
    def set_point_in_force(self) -> float:
        """The set point in force: the override's or the loop's own."""
        override = self.override
        chosen = self.set_point if override is None or override.set_point is None else override.set_point
        return chosen if self._is_angle else min(chosen, self.limits.maximum)

    @property
    def controller_in_force(self) -> Controller:
        """The controller in force: the override's or the loop's own."""
        override = self.override
        return self.controller if override is None or override.controller is None else override.controller

    def step(self, seconds: float, heave_command: float = 0.0) -> None:
        """Compute `output`; a measured value must be there.

        `seconds` is the time since the last step, `heave_command` the command downwards of this tick.
        """
        assert self.measured is not None
        controller = self.controller_in_force
        if controller is not self._running:
            controller.start()
            self._running, self._unwrapped = controller, self.measured
        set_point, measured = self.set_point_in_force, self.measured
        if controller.averages and self.mean is not None:
            measured = self.mean
        if self._is_angle:
            self._unwrapped += wrap_angle(measured - self._unwrapped)
            set_point = self._unwrapped + wrap_angle(set_point - measured)
            measured = self._unwrapped
        controller.heave_command, controller.heave_acceleration = heave_command, self.heave_acceleration
        self.output = min(max(controller.step(set_point, measured, seconds), -1.0), 1.0)

    def rest(self) -> None:
        """Stop control; the controller is reset before it is used again."""
        self._running = self.output = None

    def follow(self) -> None:
        """Set the set point to the measured value, within the limits."""
        if self.measured is not None:
            self.set_point = min(max(self.measured, self.limits.minimum), self.limits.maximum)

    def find(self, name: str) -> Controller:
        """Return the controller of this name. Raise RefusedError if there is none."""
        controller = self.controllers.get(name)
        if controller is None:
            raise RefusedError(f"there is no controller {name!r}; there are {', '.join(self.controllers)}")
        return controller

    def check(self, set_point: float) -> None:
        """Raise RefusedError for a set point out of range."""
        low, high = self.limits.minimum, self.limits.maximum
        if not low <= set_point <= high:
            raise RefusedError(
                f"a set point of {self._number(set_point)} is not between {self.describe(low, high)}"
            )

    def describe(self, *values: float) -> str:
        """Return these values with their unit, as text."""
        return f"{' and '.join(map(self._number, values))} {'°' if self._is_angle else 'm'}"

    def _number(self, value: float) -> str:
        return f"{degrees(value):.0f}" if self._is_angle else f"{value:g}"
