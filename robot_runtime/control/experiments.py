"""The experiment that runs, one at a time: begun by a command, guided by the control node's ticks."""

import threading
from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.control.experiment import Experiment, Wanted
from robot_runtime.errors import Refused
from robot_runtime.samples import Experiment as Told
from robot_runtime.samples import Mode

TELL_EVERY = 0.5
"""s."""
_LEFT: dict[Mode, str] = {
    "manual": "The pilot took over.",
    "failsafe": "The robot was stopped for a fault; its alarms tell more.",
}


class Experiments:
    """`tell` takes each document. `tick` and `guide` belong to the control loop, the rest to any thread."""

    def __init__(self, clock: Clock, tell: Callable[[Told], None]) -> None:
        self._clock = clock
        self._tell = tell
        self._lock = threading.Lock()
        self._running: tuple[int, str, Experiment] | None = None
        self._told: tuple[object, ...] = ()
        self._due = 0.0

    @property
    def loop(self) -> str | None:
        """The loop that an experiment runs on."""
        running = self._running
        return None if running is None else running[1]

    def require_none(self) -> None:
        """Raises Refused while one runs: what it measures must not change meanwhile."""
        if self._running is not None:
            raise Refused(f"An experiment runs on the {self.loop}. Wait for its end, or stop it first.")

    def begin(self, number: int, loop: str, experiment: Experiment) -> None:
        """Run it from the next tick on. Raises Refused while another runs."""
        with self._lock:
            self.require_none()
            self._running = number, loop, experiment

    def stop(self, text: str) -> None:
        """End what runs, if anything does."""
        running = self._running
        if running is not None:
            running[2].end(self._clock.now(), "stopped", text)

    def tick(self, mode: Mode) -> None:
        """Tell how it goes, and end it where the robot does not steer itself any more."""
        running = self._running
        if running is None:
            return
        if mode != "automatic":
            self.stop(_LEFT.get(mode, "The robot was disarmed."))
        number, loop, experiment = running
        now = self._clock.now()
        changed = (number, experiment.phase, experiment.cycles, experiment.bias)
        if changed != self._told or now >= self._due:
            self._told, self._due = changed, now + TELL_EVERY
            self._tell(
                Told(
                    time=now,
                    number=number,
                    kind=experiment.kind,
                    loop=loop,
                    phase=experiment.phase,
                    since=experiment.phase_since,
                    progress=experiment.progress,
                    cycles=experiment.cycles,
                    bias=experiment.bias,
                    text=experiment.text,
                )
            )
        if experiment.over:
            self._running = None

    def guide(self, loop: str, value: float) -> Wanted | None:
        """What a loop of this value is to do; None where it goes on as always."""
        running = self._running
        if running is None or running[1] != loop or running[2].over:
            return None
        return running[2].step(self._clock.now(), value)
