"""PID controllers of the depth, and of heading, pitch and roll with gains in rad."""

from collections.abc import Mapping
from typing import ClassVar

from robot_runtime.control.controllers.base import Controller, GainLimits, Rate


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
        self.start()

    def start(self) -> None:
        """Reset integral and speed."""
        self._integral = 0.0
        self._speed = Rate(self._filter)

    def step(self, set_point: float, measured: float, seconds: float) -> float:
        """Return kp e + ki ∫e dt - kd dy/dt, limited to ±1."""
        error = set_point - measured
        self._speed.update(measured, seconds)
        command = self.gains["kp"] * error + self._integral - self.gains["kd"] * self._speed.value
        limited = min(max(command, -1.0), 1.0)
        if command == limited or (command > 0) != (error > 0):
            self._integral = min(max(self._integral + self.gains["ki"] * error * seconds, -1.0), 1.0)
        return limited


def _pid_limits(kp: float, ki: float, kd: float) -> Mapping[str, GainLimits]:
    return {
        "kp": GainLimits(kp, 0.0, 20.0, "1/rad", "command for each rad of error"),
        "ki": GainLimits(ki, 0.0, 20.0, "1/(rad s)", "command for each rad of error and second"),
        "kd": GainLimits(kd, 0.0, 20.0, "s/rad", "command against each rad/s of turning"),
    }


class HeadingPid(Pid):
    """PID of the heading, which only the water's drag damps."""

    limits: ClassVar[Mapping[str, GainLimits]] = _pid_limits(0.3, 0.0, 0.3)


class PitchPid(Pid):
    """PID of the pitch. Buoyancy rights the hull faster than the fins turn, so the integral alone is used."""

    limits: ClassVar[Mapping[str, GainLimits]] = _pid_limits(0.0, 0.8, 0.0)


class RollPid(Pid):
    """PID of the roll, as `PitchPid`."""

    limits: ClassVar[Mapping[str, GainLimits]] = _pid_limits(0.0, 0.8, 0.0)
