"""One of the loops that the robot steers by: what it measures, where it should be, and who decides."""

from dataclasses import dataclass
from math import degrees, pi
from typing import Literal

from robot_runtime.contract.limits import SET_POINT, Range
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.control.controllers import CONTROLLERS, Controller
from robot_runtime.errors import RefusedError

LoopName = Literal["depth", "heading", "pitch", "roll"]
Axis = Literal["z", "yaw", "pitch", "roll"]
TILT_MAX = 0.5
"""rad."""
SET_POINTS: dict[LoopName, Range] = {
    "depth": SET_POINT,
    "heading": Range(-pi, pi),
    "pitch": Range(-TILT_MAX, TILT_MAX),
    "roll": Range(-TILT_MAX, TILT_MAX),
}
"""What a loop's set point may be; m, of the angles rad."""


@dataclass(frozen=True, slots=True)
class LoopOverride:
    """A controller and a set point for a while; None leaves the loop's own."""

    controller: Controller | None = None
    set_point: float | None = None


class ControlLoop:
    """Steers one `axis` of the navigation command by one measured value, m or rad.

    `lent` lends it for an experiment: to another controller, to another set point, also while it is not on.
    Each attribute may be set from any thread; the next tick goes by it.
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
        self.lent: LoopOverride | None = None
        self.measured: float | None = None
        self.mean: float | None = None
        """Of what was measured since the last tick, where that was more than one value."""
        self.felt: float | None = None
        """Of the depth: the mean acceleration downwards since the last tick, m/s², where its controller
        `feels` and any was measured."""
        self.output: float | None = None
        """The newest command; None where this loop does not steer."""
        self._is_angle = name != "depth"
        self._running: Controller | None = None
        self._counted_on = 0.0

    @property
    def wanted(self) -> float:
        """The set point that is in force."""
        lent = self.lent
        return self.set_point if lent is None or lent.set_point is None else lent.set_point

    @property
    def in_force(self) -> Controller:
        """The controller that decides."""
        lent = self.lent
        return self.controller if lent is None or lent.controller is None else lent.controller

    def step(self, seconds: float, down: float = 0.0) -> None:
        """Decide; `seconds` since the last step, `down` the command downwards beside this one's.

        There must be a measured value.
        """
        assert self.measured is not None
        controller = self.in_force
        if controller is not self._running:
            controller.start()
            self._running, self._counted_on = controller, self.measured
        set_point, measured = self.wanted, self.measured
        if controller.averages and self.mean is not None:
            measured = self.mean
        if self._is_angle:
            self._counted_on += wrap_angle(measured - self._counted_on)
            set_point = self._counted_on + wrap_angle(set_point - measured)
            measured = self._counted_on
        controller.down, controller.felt = down, self.felt
        self.output = min(max(controller.step(set_point, measured, seconds), -1.0), 1.0)

    def rest(self) -> None:
        """Steer no more; the controller begins anew when it is needed again."""
        self._running = self.output = None

    def follow(self) -> None:
        """Take the measured value as the set point, as far as it may be one."""
        if self.measured is not None:
            self.set_point = min(max(self.measured, self.limits.minimum), self.limits.maximum)

    def find(self, name: str) -> Controller:
        """The controller of this name. Raises RefusedError where there is none."""
        controller = self.controllers.get(name)
        if controller is None:
            raise RefusedError(f"there is no controller {name!r}; there are {', '.join(self.controllers)}")
        return controller

    def check(self, set_point: float) -> None:
        """Raises RefusedError where there may be no such set point."""
        low, high = self.limits.minimum, self.limits.maximum
        if not low <= set_point <= high:
            raise RefusedError(
                f"a set point of {self._number(set_point)} is not between {self.words(low, high)}"
            )

    def words(self, *values: float) -> str:
        """These values with their unit, for people."""
        return f"{' and '.join(map(self._number, values))} {'°' if self._is_angle else 'm'}"

    def _number(self, value: float) -> str:
        return f"{degrees(value):.0f}" if self._is_angle else f"{value:g}"
