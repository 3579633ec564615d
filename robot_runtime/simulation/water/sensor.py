"""One simulated sensor: latency, noise, offset, quantization and faults."""

from collections import deque
from random import Random

from robot_runtime.simulation.water.faults import NO_FAULT, SimulatedFault
from robot_runtime.simulation.water.parameters import SensorQuality

Numbers = tuple[float, ...]

WANDERING = 1.0
"""s between two steps of an offset's random walk."""
SAME_TIME = 1e-9
"""s; moments closer than this are one, as times are sums of many periods."""


class Sensor:
    """A sensor of one or more axes.

    It has random numbers of its own, from the seed and its name, and others for its faults: what happens to
    another sensor, and what is wrong with this one, leaves its noise as it is.
    """

    def __init__(self, name: str, quality: SensorQuality, axes: int, seed: int) -> None:
        self._noise, self._walk, self._step = quality.noise, quality.walk, quality.step
        self._latency = quality.latency
        self._interval = 1 / quality.rate
        self._gauss = Random(f"{seed} {name}").gauss
        self._chance = Random(f"{seed} {name} fault").random
        self._offset = [self._gauss(0, quality.bias) for _ in range(axes)]
        self._due = 0.0
        self._wanders = WANDERING
        self._shown: Numbers | None = None
        self._coming: deque[tuple[float, Numbers]] = deque()
        self._fault = NO_FAULT
        self._since = 0.0
        self.holds = False
        """True if its newest reading was lost, so that it repeats an older one."""

    def set_fault(self, fault: SimulatedFault, time: float) -> None:
        """Sets the fault from `time` (s) on, in place of any other."""
        self._fault = fault
        self._since = time
        self.holds = False

    def read(self, time: float, actual: Numbers) -> Numbers:
        """Returns the reading at this time (s) for these actual values. The first reading has no latency."""
        if time > self._due - SAME_TIME:
            self._due = max(self._due + self._interval, time)
            reading = self._apply_fault(time, self._add_noise(time, actual))
            self.holds = reading is None
            if self._shown is None:
                self._shown = reading or actual
            elif reading is not None and self._latency == 0:
                self._shown = reading
            elif reading is not None:
                self._coming.append((time + self._latency, reading))
        coming = self._coming
        while coming and coming[0][0] < time + SAME_TIME:
            self._shown = coming.popleft()[1]
        return self._shown if self._shown is not None else actual

    def _add_noise(self, time: float, actual: Numbers) -> Numbers:
        gauss, noise = self._gauss, self._noise
        while time > self._wanders - SAME_TIME:
            self._wanders += WANDERING
            self._offset = [offset + gauss(0, self._walk) for offset in self._offset]
        return tuple(
            [value + offset + gauss(0, noise) for value, offset in zip(actual, self._offset, strict=True)]
        )

    def _apply_fault(self, time: float, reading: Numbers) -> Numbers | None:
        """The reading as it comes out in steps; None where it is lost."""
        fault = self._fault
        if fault is not NO_FAULT:
            if fault.kind == "stuck" or (fault.kind == "dropout" and self._chance() < (fault.share or 0)):
                return None
            if fault.kind == "spike" and self._chance() < (fault.share or 0):
                jump = (fault.size or 0) if self._chance() < 0.5 else -(fault.size or 0)
                reading = tuple([value + jump for value in reading])
            elif fault.kind == "drift":
                gone = (fault.speed or 0) * (time - self._since)
                reading = tuple([value + gone for value in reading])
        step = self._step
        return tuple([step * round(value / step) for value in reading]) if step else reading
