"""Runs one experiment at a time: started by a command, advanced before each tick."""

import threading
from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Experiment, Mode
from robot_runtime.control.attitude import wrap_angle
from robot_runtime.control.experiment import LoopExperiment
from robot_runtime.control.loop import ControlLoop
from robot_runtime.errors import RefusedError

REPORT_PERIOD = 0.5
"""s."""
_LEFT: dict[Mode, str] = {
    "manual": "The pilot took over.",
    "failsafe": "The robot was stopped for a fault; see its alarms.",
}


class Experiments:
    """`on_report` takes each document. `tick` belongs to the control loop, the rest to any thread."""

    def __init__(self, clock: Clock, on_report: Callable[[Experiment], None]) -> None:
        self._clock = clock
        self._on_report = on_report
        self._lock = threading.Lock()
        self._running: tuple[int, ControlLoop, LoopExperiment] | None = None
        self._reported: tuple[object, ...] = ()
        self._due = 0.0

    def require_none(self) -> None:
        """Raises RefusedError while an experiment runs: its loop must not change meanwhile."""
        running = self._running
        if running is not None:
            raise RefusedError(
                f"An experiment runs on the {running[1].name}. Wait for its end, or stop it first."
            )

    def begin(self, number: int, loop: ControlLoop, experiment: LoopExperiment) -> None:
        """Run it from the next tick on. Raises RefusedError while another runs."""
        with self._lock:
            self.require_none()
            self._running = number, loop, experiment

    def stop(self, text: str) -> None:
        """End what runs, if anything does."""
        running = self._running
        if running is not None:
            running[2].end("stopped", text)

    def tick(self, mode: Mode) -> None:
        """Advances the experiment and overrides its loop; ends it when the robot leaves automatic."""
        running = self._running
        if running is None:
            return
        number, loop, experiment = running
        if mode != "automatic":
            experiment.end("stopped", _LEFT.get(mode, "The robot was disarmed."))
        elif loop.measured is not None and not experiment.over:
            near = experiment.middle
            experiment.observe(
                loop.measured if loop.name == "depth" else near + wrap_angle(loop.measured - near)
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
