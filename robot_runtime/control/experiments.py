"""Experiments on one loop: a step of its set point, or a relay in place of its controller.

They override the loop for as long as they run and change none of its settings.
"""

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import ClassVar

from robot_runtime.clock import Clock
from robot_runtime.contract.commands import RelayExperimentCommand, StepExperimentCommand
from robot_runtime.contract.documents import Experiment, ExperimentKind, ExperimentPhase, Mode
from robot_runtime.contract.limits import LoopName, describe_value
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.control.controllers.base import Controller, GainLimits
from robot_runtime.control.loop import ControlLoop, LoopOverride
from robot_runtime.errors import RefusedError

SETTLED_SECONDS = 2.0
"""s for which the value must stay near the start before the step."""
MARGIN = 0.1
"""Share of the span between the limits by which the value must be inside before they are enforced."""
BALANCED = 0.1
"""Share of a cycle by which its halves may differ for the relay to count as balanced."""
BALANCING_MOST = 6
"""Cycles after which it continues unbalanced: the bias is at its limit, or the water is not still."""
REPORT_PERIOD = 0.5
"""s between two reports of an unchanged phase."""
_END_REASONS: dict[Mode, str] = {
    "manual": "The pilot took over.",
    "failsafe": "The robot was stopped for a fault; see its alarms.",
}


class LoopExperiment(ABC):
    """Base of the experiments.

    Call `observe` before each tick until it is `over`; `text` explains an early end.
    """

    kind: ClassVar[ExperimentKind]

    def __init__(self, clock: Clock, loop: LoopName, low: float, high: float) -> None:
        self.phase: ExperimentPhase = "settling"
        self.phase_since = self._began = clock.now()
        self.progress = 0.0
        """Share that is done, 0 to 1."""
        self.text = ""
        self.cycles = 0
        """Cycles of a relay since it was balanced."""
        self.bias = 0.0
        """Mean command of a relay, which balances the load, -1 to 1."""
        self.middle = (low + high) / 2
        self._clock = clock
        self._loop: LoopName = loop
        self._low, self._high = low, high
        self._inside = False

    @property
    @abstractmethod
    def override(self) -> LoopOverride:
        """The override of the loop from now on."""

    @property
    def over(self) -> bool:
        """True after the experiment has ended."""
        return self.phase in ("complete", "stopped", "failed")

    def observe(self, value: float) -> None:
        """Take the loop's measured value; end the experiment beyond the limits."""
        if self._inside and not self._low <= value <= self._high:
            last, low, high = (
                describe_value(self._loop, number) for number in (value, self._low, self._high)
            )
            self.end("failed", f"It ended at {last}, which is beyond the limits, {low} to {high}.")
        # It may begin at a limit, such as the surface.
        margin = MARGIN * (self._high - self._low)
        self._inside = self._inside or self._low + margin <= value <= self._high - margin
        self._observe(value)

    def end(self, phase: ExperimentPhase, text: str = "") -> None:
        """End the experiment; the first reason counts."""
        if not self.over:
            self.text = text
            self._enter(phase)

    @abstractmethod
    def _observe(self, value: float) -> None:
        """Take the measured value; see `observe`."""

    def _enter(self, phase: ExperimentPhase) -> None:
        self.phase, self.phase_since = phase, self._clock.now()


class StepExperiment(LoopExperiment):
    """A step of the set point."""

    kind = "step"

    def __init__(self, settings: StepExperimentCommand, clock: Clock) -> None:
        super().__init__(clock, settings.loop, settings.low, settings.high)
        self._settings = settings
        self._last_outside = self._began

    @property
    def override(self) -> LoopOverride:
        """A set point for the loop's own controller."""
        return LoopOverride(
            set_point=self._settings.start if self.phase == "settling" else self._settings.target
        )

    def _observe(self, value: float) -> None:
        settings, now = self._settings, self._clock.now()
        if abs(value - settings.start) > settings.tolerance:
            self._last_outside = now
        if self.phase == "settling":
            waited = now - self._began
            self.progress = 0.5 * min(waited / settings.settle, 1.0) if settings.settle else 0.5
            if waited >= settings.settle or now - self._last_outside >= SETTLED_SECONDS:
                self._enter("running")
        if self.phase == "running":
            self.progress = 0.5 + 0.5 * min((now - self.phase_since) / settings.duration, 1.0)
            if now - self.phase_since >= settings.duration:
                self.end("complete")


class RelayExperiment(LoopExperiment):
    """A relay in the controller's place (Åström and Hägglund, Automatica 20, 1984).

    A load, here buoyancy, makes the halves of each cycle unequal, and period and amplitude wrong (Hang,
    Åström and Ho, IEE Proceedings-D 140, 1993). The mean command over a cycle becomes the relay's bias until
    the halves are equal; only later cycles count.
    """

    kind = "relay"

    def __init__(self, settings: RelayExperimentCommand, clock: Clock) -> None:
        super().__init__(clock, settings.loop, settings.low, settings.high)
        self._settings = settings
        self._override = LoopOverride(_Relay(self), settings.set_point)
        self._side = 0.0
        self._switched = self._began
        self._first_half = 0.0
        self._balancing = 0

    @property
    def override(self) -> LoopOverride:
        """The relay and its set point."""
        return self._override

    def command(self, error: float) -> float:
        """Return the relay's command, -1 to 1, at this error."""
        side = self._side or (1.0 if error > 0 else -1.0)
        if error * side < -self._settings.hysteresis:
            side = -side
        if self._side and side != self._side:
            self._side = side
            self._switch()
        self._side = side
        return self.bias + side * self._settings.amplitude

    def _observe(self, value: float) -> None:  # noqa: ARG002 - the relay gets a newer value
        settings = self._settings
        if self._clock.now() - self._began >= settings.duration:
            text = f"There were {self.cycles} of {settings.cycles} cycles within {settings.duration:g} s."
            self.end("failed", text)

    def _switch(self) -> None:
        """Record a switching of the relay; every second switching completes a cycle."""
        now = self._clock.now()
        half, self._switched = now - self._switched, now
        if self.phase == "settling":
            # The first approach is no half cycle.
            self._enter("balancing")
        elif self._side < 0:
            self._first_half = half
        elif self._first_half:
            self._complete((self._first_half - half) / (self._first_half + half))
            self._first_half = 0.0

    def _complete(self, asymmetry: float) -> None:
        if self.phase == "balancing":
            self._balancing += 1
            if abs(asymmetry) <= BALANCED or self._balancing >= BALANCING_MOST:
                self._enter("running")
            else:
                room = 1.0 - self._settings.amplitude
                self.bias = min(max(self.bias + self._settings.amplitude * asymmetry, -room), room)
        elif self.phase == "running":
            self.cycles += 1
            self.progress = self.cycles / self._settings.cycles
            if self.cycles >= self._settings.cycles:
                self.end("complete")


class _Relay(Controller):
    """The relay of an experiment, as a controller."""

    name = "relay"
    title = "Relay"
    limits: ClassVar[Mapping[str, GainLimits]] = {}

    def __init__(self, experiment: RelayExperiment) -> None:
        super().__init__()
        self._experiment = experiment

    def step(self, set_point: float, measured: float, seconds: float) -> float:  # noqa: ARG002
        """Return the bias, plus or minus the amplitude."""
        return self._experiment.command(set_point - measured)


class Experiments:
    """The experiments of a robot, one at a time. `tick` belongs to the control loop, the rest to any thread.

    `on_report` takes each document.
    """

    def __init__(self, clock: Clock, on_report: Callable[[Experiment], None]) -> None:
        self._clock = clock
        self._on_report = on_report
        self._lock = threading.Lock()
        self._running: tuple[int, ControlLoop, LoopExperiment] | None = None
        self._reported: tuple[object, ...] = ()
        self._due = 0.0

    def require_none(self) -> None:
        """Raise RefusedError while an experiment runs: its loop must not change meanwhile."""
        running = self._running
        if running is not None:
            raise RefusedError(
                f"An experiment runs on the {running[1].name}. Wait for its end, or stop it first."
            )

    def begin(self, number: int, loop: ControlLoop, experiment: LoopExperiment) -> None:
        """Start an experiment at the next tick. Raise RefusedError while another runs."""
        with self._lock:
            self.require_none()
            self._running = number, loop, experiment

    def stop(self, text: str) -> None:
        """Stop the running experiment, if any."""
        running = self._running
        if running is not None:
            running[2].end("stopped", text)

    def tick(self, mode: Mode) -> None:
        """Advance the experiment and override its loop; end it when the robot leaves automatic."""
        running = self._running
        if running is None:
            return
        number, loop, experiment = running
        if mode != "automatic":
            experiment.end("stopped", _END_REASONS.get(mode, "The robot was disarmed."))
        elif loop.measured is not None and not experiment.over:
            middle = experiment.middle
            experiment.observe(
                loop.measured if loop.name == "depth" else middle + wrap_angle(loop.measured - middle)
            )
        loop.override = None if experiment.over else experiment.override
        self._report_changes(number, loop, experiment)
        if experiment.over:
            self._running = None

    def _report_changes(self, number: int, loop: ControlLoop, experiment: LoopExperiment) -> None:
        now = self._clock.now()
        changed = (number, experiment.phase, experiment.cycles, experiment.bias)
        if changed == self._reported and now < self._due:
            return
        self._reported, self._due = changed, now + REPORT_PERIOD
        self._on_report(
            Experiment(
                time=now,
                number=number,
                kind=experiment.kind,
                loop=loop.name,
                phase=experiment.phase,
                since=experiment.phase_since,
                progress=experiment.progress,
                cycles=experiment.cycles,
                bias=experiment.bias,
                text=experiment.text,
            )
        )
