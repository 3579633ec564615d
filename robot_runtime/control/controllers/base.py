"""Base class of the controllers: set point and measured value in, command between -1 and 1 out.

A controller is one small class: a name, a title, its gains with their limits, and `step`.
docs/develop/add-a-controller.md says how one is added.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from math import copysign, isfinite, sqrt
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class GainLimits:
    """Default, minimum and maximum of a gain, with its unit and meaning."""

    default: float
    minimum: float
    maximum: float
    unit: str
    meaning: str


class Controller(ABC):
    """Base of all controllers. Values are in m of depth, downwards, or in rad of an unwrapped angle."""

    name: ClassVar[str]
    title: ClassVar[str]
    limits: ClassVar[Mapping[str, GainLimits]]
    averages: ClassVar[bool] = False
    """True if it uses the mean of the values since the last step instead of the newest."""
    needs_heave_acceleration: ClassVar[bool] = False
    """True if it uses `heave_acceleration`."""

    def __init__(self) -> None:
        self.heave_command = 0.0
        """For a controller of another axis: the command downwards that is sent with its own."""
        self.heave_acceleration: float | None = None
        """m/s²: the mean acceleration downwards since the last step, if it `needs_heave_acceleration` and any
        was measured."""
        self.gains = {name: limits.default for name, limits in self.limits.items()}

    @classmethod
    def check(cls, gains: Mapping[str, float]) -> None:
        """Raise ValueError on unknown names and values out of range."""
        for name, value in gains.items():
            limits = cls.limits.get(name)
            if limits is None:
                raise ValueError(f"{cls.title} has no gain {name!r}; it has {', '.join(cls.limits)}")
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or not isfinite(value) or not limits.minimum <= value <= limits.maximum:
                span = f"{limits.minimum:g} and {limits.maximum:g} {limits.unit}".strip()
                raise ValueError(f"{name} is {value!r}; it must be a number between {span}")

    def tune(self, gains: Mapping[str, float]) -> None:
        """Set some gains, all or none. Raise ValueError on unknown names and values out of range."""
        self.check(gains)
        self.gains |= {name: float(value) for name, value in gains.items()}

    def start(self) -> None:  # noqa: B027 - most controllers have no state
        """Reset the state; called whenever the controller takes over."""

    @abstractmethod
    def step(self, set_point: float, measured: float, seconds: float) -> float:
        """Return the command, -1 to 1; `seconds` is the time since the last step, 0 at the first."""


class Rate:
    """The rate of change of a value, low-pass filtered; 0 until two values were taken."""

    def __init__(self, time_constant: float) -> None:
        self.value = 0.0
        self._time_constant = time_constant
        self._last: float | None = None

    def update(self, measured: float, seconds: float) -> None:
        """Take the value measured `seconds` after the previous one."""
        if self._last is not None and seconds > 0:
            rate = (measured - self._last) / seconds
            self.value += (rate - self.value) * seconds / (self._time_constant + seconds)
        self._last = measured


def braking_speed(distance: float, deceleration: float, slope: float) -> float:
    """Return the speed from which this deceleration stops within the distance: √(2·a·distance).

    Near 0 it is `slope`·distance: a boundary layer, J.-J. Slotine and W. Li, Applied Nonlinear Control,
    1991, 7.2.
    """
    linear = deceleration / slope**2
    if abs(distance) <= linear:
        return slope * distance
    return copysign(sqrt(2 * deceleration * (abs(distance) - linear / 2)), distance)
