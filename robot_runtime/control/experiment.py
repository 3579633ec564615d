"""Experiments on one loop, tick by tick: a step of its set point, or a relay in its controller's place.

Each says at a tick what the loop is to do, and in which phase it is. Nothing of the loop itself is changed,
so that there is nothing to put back: without an experiment it goes on as it was.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from robot_runtime.samples import ExperimentKind, ExperimentPhase

SETTLED_SECONDS = 2.0
"""s for which the value has to have stayed about the start before the step."""
MARGIN = 0.1
"""Share of the way between the limits by which the value has to be within them before they count."""
BALANCED = 0.1
"""Share of a cycle by which its halves may differ for the relay to count as balanced."""
BALANCING_MOST = 6
"""Cycles after which it goes on unbalanced: the bias is at its limit then, or the water is not still."""


class Wanted(NamedTuple):
    """What the loop is to do now; without an output its controller decides."""

    set_point: float
    output: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class StepSettings:
    """From `start` to `target` and `duration` (s) there.

    The start is held until the value stays within `tolerance` of it, and for `settle` (s) at most. Values in
    the loop's unit; those beyond `low` and `high` end it.
    """

    start: float
    target: float
    tolerance: float
    settle: float
    duration: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RelaySettings:
    """`cycles` of a relay of ±`amplitude` (share of the most) about `set_point`.

    It switches `hysteresis` beyond the set point, and gives up after `duration` (s). Values in the loop's
    unit; those beyond `low` and `high` end it.
    """

    set_point: float
    amplitude: float
    hysteresis: float
    cycles: int
    duration: float
    low: float
    high: float


class Experiment(ABC):
    """Base of both: `step` at each tick until it is `over`; `text` says why where it did not complete."""

    kind: ClassVar[ExperimentKind]

    def __init__(self, now: float, low: float, high: float) -> None:
        self.phase: ExperimentPhase = "settling"
        self.phase_since = now
        self.progress = 0.0
        """Share that is done, as far as that is known."""
        self.text = ""
        self.cycles = 0
        """Of a relay, that count."""
        self.bias = 0.0
        """Of a relay: the mean command, which balances the load."""
        self._began = now
        self._low, self._high = low, high
        self._inside = False

    def step(self, now: float, value: float) -> Wanted:
        """What the loop is to do, whose value is this."""
        if self._inside and not self._low <= value <= self._high:
            span = f"{self._low:g} to {self._high:g}"
            self.end(now, "failed", f"It ended at {value:.2f}, which is beyond the limits ({span}).")
        # It may begin at a limit: at the surface, for one.
        margin = MARGIN * (self._high - self._low)
        self._inside = self._inside or self._low + margin <= value <= self._high - margin
        return self._step(now, value)

    @property
    def over(self) -> bool:
        """Whether it has ended."""
        return self.phase in ("complete", "stopped", "failed")

    def end(self, now: float, phase: ExperimentPhase, text: str = "") -> None:
        """It is over; the first reason counts."""
        if not self.over:
            self.text = text
            self._enter(phase, now)

    @abstractmethod
    def _step(self, now: float, value: float) -> Wanted:
        """The same."""

    def _enter(self, phase: ExperimentPhase, now: float) -> None:
        self.phase, self.phase_since = phase, now


class StepExperiment(Experiment):
    """A step of the set point."""

    kind = "step"

    def __init__(self, settings: StepSettings, now: float) -> None:
        super().__init__(now, settings.low, settings.high)
        self._settings = settings
        self._away = now

    def _step(self, now: float, value: float) -> Wanted:
        wanted = self._settings
        if abs(value - wanted.start) > wanted.tolerance:
            self._away = now
        if self.phase == "settling":
            waited = now - self._began
            self.progress = 0.5 * min(waited / wanted.settle, 1.0) if wanted.settle else 0.5
            if waited >= wanted.settle or now - self._away >= SETTLED_SECONDS:
                self._enter("running", now)
        if self.phase == "running":
            self.progress = 0.5 + 0.5 * min((now - self.phase_since) / wanted.duration, 1.0)
            if now - self.phase_since >= wanted.duration:
                self.end(now, "complete")
        return Wanted(wanted.start if self.phase == "settling" else wanted.target, None)


class RelayExperiment(Experiment):
    """A relay in the controller's place (Åström and Hägglund, Automatica 20, 1984).

    A load, here buoyancy, makes one half of each cycle longer than the other, and period and amplitude wrong
    (Hang, Åström and Ho, IEE Proceedings-D 140, 1993). The mean command over a cycle is what balances it: it
    becomes the relay's bias, until the halves are alike. Only then cycles count.
    """

    kind = "relay"

    def __init__(self, settings: RelaySettings, now: float) -> None:
        super().__init__(now, settings.low, settings.high)
        self._settings = settings
        self._side = 0.0
        self._switched = now
        self._down = 0.0
        self._balancing = 0

    def _step(self, now: float, value: float) -> Wanted:
        wanted = self._settings
        error = wanted.set_point - value
        side = self._side or (1.0 if error > 0 else -1.0)
        if error * side < -wanted.hysteresis:
            side = -side
        if self._side and side != self._side:
            self._switch(now)
        self._side = side
        if now - self._began >= wanted.duration:
            words = f"There were {self.cycles} of {wanted.cycles} cycles within {wanted.duration:g} s."
            self.end(now, "failed", words)
        return Wanted(wanted.set_point, self.bias + side * wanted.amplitude)

    def _switch(self, now: float) -> None:
        """It turns over: after each second half a cycle is whole."""
        half, self._switched = now - self._switched, now
        if self.phase == "settling":
            # The way there was no half.
            self._enter("balancing", now)
        elif self._side > 0:
            self._down = half
        elif self._down:
            self._complete(now, self._down, half)
            self._down = 0.0

    def _complete(self, now: float, forth: float, back: float) -> None:
        asymmetry = (forth - back) / (forth + back)
        if self.phase == "balancing":
            self._balancing += 1
            if abs(asymmetry) <= BALANCED or self._balancing >= BALANCING_MOST:
                self._enter("running", now)
            else:
                room = 1.0 - self._settings.amplitude
                self.bias = min(max(self.bias + self._settings.amplitude * asymmetry, -room), room)
        elif self.phase == "running":
            self.cycles += 1
            self.progress = self.cycles / self._settings.cycles
            if self.cycles >= self._settings.cycles:
                self.end(now, "complete")
