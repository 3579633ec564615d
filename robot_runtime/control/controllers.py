"""Depth controllers: from set point and depth to a vertical command between -1 and 1, downwards.

A controller is one small class: a name, a title, its gains with their limits, and `step`. Adding one means
writing the class and naming it in `CONTROLLERS`.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class GainLimits:
    """What a gain may be: its default, its least and its most."""

    default: float
    minimum: float
    maximum: float
    unit: str
    meaning: str


_OUTPUT = GainLimits(1.0, 0.0, 1.0, "", "size of the command, as a share of the most")


class Controller(ABC):
    """Base of the depth controllers."""

    name: ClassVar[str]
    title: ClassVar[str]
    limits: ClassVar[Mapping[str, GainLimits]]

    def __init__(self) -> None:
        self.gains = {name: limits.default for name, limits in self.limits.items()}

    def tune(self, gains: Mapping[str, float]) -> None:
        """Set some gains, all or none. Raises ValueError on unknown names and values out of range."""
        for name, value in gains.items():
            self._check(name, value)
        self.gains |= {name: float(value) for name, value in gains.items()}

    def start(self) -> None:  # noqa: B027 - most controllers have no past
        """Forget the past: called whenever the controller takes over."""

    @abstractmethod
    def step(self, set_point: float, depth: float, seconds: float) -> float:
        """The command, -1 to 1; depths in m, `seconds` since the last step."""

    def _check(self, name: str, value: float) -> None:
        limits = self.limits.get(name)
        if limits is None:
            raise ValueError(f"{self.title} has no gain {name!r}; it has {', '.join(self.limits)}")
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not number or not math.isfinite(value) or not limits.minimum <= value <= limits.maximum:
            span = f"{limits.minimum:g} and {limits.maximum:g} {limits.unit}".strip()
            raise ValueError(f"{name} is {value!r}; it must be a number between {span}")


class BangBang(Controller):
    """Always full command towards the set point, as in the thesis."""

    name = "bang_bang"
    title = "Bang-bang"
    limits: ClassVar[Mapping[str, GainLimits]] = {"output": _OUTPUT}

    def step(self, set_point: float, depth: float, seconds: float) -> float:  # noqa: ARG002
        """Full command with the sign of the error."""
        error = set_point - depth
        return math.copysign(self.gains["output"], error) if error else 0.0


class BangBangDeadZone(Controller):
    """Bang-bang that rests while it is close enough."""

    name = "bang_bang_dead_zone"
    title = "Bang-bang with dead zone"
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "output": _OUTPUT,
        "dead_zone": GainLimits(0.05, 0.0, 1.0, "m", "no command within this distance of the set point"),
    }

    def step(self, set_point: float, depth: float, seconds: float) -> float:  # noqa: ARG002
        """Full command with the sign of the error outside the dead zone, none inside."""
        error = set_point - depth
        return math.copysign(self.gains["output"], error) if abs(error) > self.gains["dead_zone"] else 0.0


class Pid(Controller):
    """PID in its parallel form: derivative on the filtered measurement, integral clamped against wind-up.

    Åström and Hägglund, Advanced PID Control, 2006, chapter 3. The integral stops growing while the command
    is at its limit and the error would drive it further.
    """

    name = "pid"
    title = "PID"
    limits: ClassVar[Mapping[str, GainLimits]] = {
        "kp": GainLimits(3.0, 0.0, 50.0, "1/m", "command for each metre of error"),
        "ki": GainLimits(0.4, 0.0, 20.0, "1/(m s)", "command for each metre of error and second"),
        "kd": GainLimits(2.0, 0.0, 50.0, "s/m", "command against each m/s of speed"),
    }
    _filter = 0.2  # s, time constant of the speed: the depth comes in steps of some millimetres

    def __init__(self) -> None:
        super().__init__()
        self._integral = 0.0
        self._speed = 0.0
        self._last: float | None = None

    def start(self) -> None:
        """Forget integral and speed."""
        self._integral = 0.0
        self._speed = 0.0
        self._last = None

    def step(self, set_point: float, depth: float, seconds: float) -> float:
        """kp e + ki ∫e dt - kd dz/dt, limited to ±1."""
        error = set_point - depth
        if self._last is not None and seconds > 0:
            speed = (depth - self._last) / seconds
            self._speed += (speed - self._speed) * seconds / (self._filter + seconds)
        self._last = depth
        wanted = self.gains["kp"] * error + self._integral - self.gains["kd"] * self._speed
        limited = min(max(wanted, -1.0), 1.0)
        if wanted == limited or (wanted > 0) != (error > 0):
            self._integral = min(max(self._integral + self.gains["ki"] * error * seconds, -1.0), 1.0)
        return limited


CONTROLLERS: tuple[type[Controller], ...] = (BangBang, BangBangDeadZone, Pid)
