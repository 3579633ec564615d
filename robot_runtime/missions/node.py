"""The mission node: checks, begins, ticks and ends one mission at a time.

It commands nothing itself. It overrides set points and the course of the control node, which a change of mode
ends, sets parameters through the registry, and says STOP. Supervisor and board stay above it.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Event, Mission, Mode, ParameterValue, Severity
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.missions import WET_DEPTH, MissionLimits, MissionPhase
from robot_runtime.contract.topics import MISSION
from robot_runtime.control.node import ControlNode
from robot_runtime.control.supervisor import Supervisor
from robot_runtime.errors import RefusedError
from robot_runtime.missions.senses import MissionSenses
from robot_runtime.parameters.registry import Registry
from robot_runtime.transport.bus import Bus
from robot_runtime.vision.interface import Vision

if TYPE_CHECKING:
    from robot_runtime.missions.document import MissionDocument
    from robot_runtime.missions.run import MissionRun

log = logging.getLogger(__name__)

REPORT_PERIOD = 1.0
"""s between two documents of an unchanged mission."""
BATTERY_SAG = 2.0
"""s for which the battery may be under its limit, as it sags under load."""
LATE = 1.0
"""s that a tick may take of the mission's clock at most; a longer one stops the robot anyway."""
SURFACED_FOR = 2.0
"""s at the surface after which a mission's robot counts as surfaced."""
_SWIMS_IN: tuple[Mode, ...] = ("automatic", "manual")
"""The modes in which a mission runs or is paused; any other one ends it."""
_ERROR = "An error in the software ended it; see the runtime's log."
_ENDS: dict[Mode, str] = {
    "disarmed": "The robot was stopped.",
    "failsafe": "The robot was stopped for a fault; see its alarms.",
    "test": "The fins are checked.",
}


@dataclass(slots=True)
class _Ascent:
    """A mission that has ended and whose robot rises; `since`: it is at the surface since then (s)."""

    run: "MissionRun"
    phase: MissionPhase
    text: str
    since: float | None = None


@dataclass(frozen=True, slots=True)
class LoadedMission:
    """A mission that may begin; `text` is its document."""

    document: "MissionDocument"
    text: str


class MissionRunner:
    """Runner of missions. `tick` belongs to the control loop, whose lock it holds; the rest to any thread.

    `stop` stops the robot. `on_mission` takes each document, `on_event` each event.
    """

    def __init__(
        self,
        clock: Clock,
        limits: MissionLimits,
        senses: MissionSenses,
        parameters: Registry,
        stop: Callable[[str], None],
        on_mission: Callable[[Mission], None],
        on_event: Callable[[Event], None],
    ) -> None:
        self.limits = limits
        self._clock = clock
        self._senses = senses
        self._parameters = parameters
        self._stop = stop
        self._on_mission = on_mission
        self._on_event = on_event
        self._loaded: LoadedMission | None = None
        self._run: MissionRun | None = None
        self._ascent: _Ascent | None = None
        self._ended_in: Mode | None = None
        """The mode that ended it, which the next tick sees to, whatever followed."""
        self._number = 0
        self._ticked = 0.0
        self._held = False
        self._was_paused = False
        self._ending: str | None = None
        self._reported: object = None
        self._due = 0.0
        self._battery_seen = self._watched = clock.now()

    @property
    def active(self) -> bool:
        """True from the arming for a mission to its end."""
        return self._run is not None or self._loaded is not None

    def require_none(self) -> None:
        """Raise RefusedError while a mission runs: nothing else may tune the robot meanwhile."""
        if self.active:
            raise RefusedError("A mission runs. Wait for its end, or end it first.")

    def see_pages(self, count: int) -> None:
        """Take the number of operators' pages."""
        if count > 0:
            self._watched = self._clock.now()

    def load(self, text: str, library: dict[str, str]) -> LoadedMission:
        """Read a mission and ask its steps whether this robot can do them.

        Raise RefusedError with all reasons.
        """
        # With the tree's library, which takes its time on a small Pi.
        from robot_runtime.missions.checks import check_start
        from robot_runtime.missions.document import read_mission
        from robot_runtime.missions.tree import MissionTree as MissionTree

        try:
            document = read_mission(text, library, self.limits)
        except ConfigError as problem:
            raise RefusedError(". ".join(problem.texts) + ".") from problem
        if problems := check_start(document, self._senses, self._parameters):
            raise RefusedError(" ".join(problems))
        return LoadedMission(document, text)

    def prepare(self, mission: LoadedMission) -> None:
        """Have the mission begin with the next tick: the robot has been armed for it. It never blocks."""
        self._loaded, self._ended_in = mission, None

    def change_mode(self, mode: Mode) -> None:
        """Take each new mode of the robot. Never blocks, because a STOP takes this way, too.

        A mode that ends a mission ends it for good, also one that has not begun yet, and also where the robot
        is armed again before the next tick.
        """
        if mode not in _SWIMS_IN and self.active:
            self._ended_in = mode

    def pause(self, on: bool) -> None:
        """Pause, or go on. Raise RefusedError where no mission runs."""
        self._require()
        self._held = on

    def skip(self) -> None:
        """End the running steps as a success. Raise RefusedError where no mission runs."""
        self._require().skip()

    def end(self, why: str) -> None:
        """End the mission with the next tick. Raise RefusedError where no mission runs."""
        self._require()
        self._ending = why

    def tick(self, mode: Mode) -> None:
        """Advance the mission in this mode of the robot; begin a prepared one."""
        mode = self._ended_in or mode
        if self._loaded is not None and (mode in _SWIMS_IN or self._ended_in is not None):
            self._begin(self._loaded)
        run = self._run
        if run is None:
            self._watch_ascent()
            return
        try:
            self._advance(run, mode)
        except Exception:
            log.exception("a mission failed")
            self._finish(run, "failed", _ERROR, mode)

    def _require(self) -> "MissionRun":
        run = self._run
        if run is None:
            raise RefusedError("No mission runs.")
        return run

    def _begin(self, mission: LoadedMission) -> None:
        from robot_runtime.missions.run import MissionRun

        self._number += 1
        self._held, self._was_paused, self._ending = False, False, None
        self._ticked = self._battery_seen = self._watched = self._clock.now()
        run = MissionRun(
            mission.document,
            mission.text,
            self._number,
            self._clock,
            self._senses,
            self._parameters,
            self._on_event,
        )
        self._run, self._loaded, self._ascent = run, None, None
        self._say(f"Mission “{mission.document.title}” begins.")
        self._report(run, "running", "", whole=True)

    def _advance(self, run: "MissionRun", mode: Mode) -> None:
        now = self._clock.now()
        seconds, self._ticked = min(now - self._ticked, LATE), now
        run.see_depth()
        if mode not in _SWIMS_IN:
            self._finish(run, "ended", _ENDS[mode], mode)
        elif self._ending is not None:
            self._finish(run, "ended", self._ending, mode)
        elif broken := self._find_broken_limit(run, now):
            self._finish(run, "failed", broken, mode)
        elif mode == "manual" or self._held:
            self._wait(run, mode, seconds)
        else:
            if self._was_paused:
                self._was_paused = False
                run.resume()
            status = run.tick(seconds)
            if run.surfaced or status == "done":
                self._finish(run, "succeeded", "It is done.", mode)
            elif status == "failed":
                self._finish(run, "failed", run.failure, mode)
            else:
                self._report(run, "running", "")

    def _wait(self, run: "MissionRun", mode: Mode, seconds: float) -> None:
        self._was_paused = True
        run.paused += seconds
        if run.paused > run.document.limits.pause:
            text = f"It was paused for longer than {run.document.limits.pause:g} s."
            self._finish(run, "failed", text, mode)
            return
        if mode == "manual":
            run.release()
        else:
            run.rest()
        self._report(run, "paused", "Somebody steers by hand." if mode == "manual" else "It was paused.")

    def _find_broken_limit(self, run: "MissionRun", now: float) -> str:
        limits = run.document.limits
        battery = self._senses.battery
        if battery is not None and battery >= limits.battery:
            self._battery_seen = now
        if self._senses.depth > limits.depth:
            return f"It was at {self._senses.depth:.2f} m, below its limit of {limits.depth:g} m."
        if run.elapsed > limits.time:
            return f"It took longer than its limit of {limits.time:g} s."
        if limits.battery and now - self._battery_seen > BATTERY_SAG:
            volts = "not measured any more" if battery is None else f"at {battery:.2f} V"
            return f"The battery is {volts}; its limit is {limits.battery:g} V."
        if limits.unwatched and now - self._watched > limits.unwatched:
            return f"No operator's page was open for {limits.unwatched:g} s."
        return ""

    def _finish(self, run: "MissionRun", phase: MissionPhase, text: str, mode: Mode) -> None:
        unrestored: dict[str, ParameterValue] = {}
        try:
            unrestored = run.end()
        except Exception:
            log.exception("a mission could not be ended in order")
            phase, text = "failed", _ERROR
        finally:
            # Not before: what a mission puts back is no change of an operator's, which would be stored.
            self._run = None
            if mode in _SWIMS_IN:
                self._stop(f"The mission is over: {text}")
        if unrestored:
            names = ", ".join(f"{name} to {value}" for name, value in unrestored.items())
            self._say(f"Some parameters are not put back: set {names}.", caution=True)
        outcome = {"succeeded": "succeeded", "failed": "failed"}.get(phase, "was ended")
        self._say(f"Mission “{run.document.title}” {outcome}. {text}", caution=phase == "failed")
        self._on_mission(run.describe(phase, text, whole=True))
        if run.deepest > WET_DEPTH:
            self._ascent = _Ascent(run, phase, text)

    def _watch_ascent(self) -> None:
        """Publish the end once more, with its time, when the robot has come up."""
        ascent, now = self._ascent, self._clock.now()
        if ascent is None:
            return
        if self._senses.depth > WET_DEPTH:
            ascent.since = None
        elif ascent.since is None:
            ascent.since = now
        elif now - ascent.since >= SURFACED_FOR:
            self._ascent = None
            self._say("The robot is at the surface.")
            end = ascent.run.describe(ascent.phase, ascent.text, whole=True, surfaced=ascent.since)
            self._on_mission(end)

    def _report(self, run: "MissionRun", phase: MissionPhase, text: str, *, whole: bool = False) -> None:
        now = self._clock.now()
        changed = (self._number, phase, text, run.statuses)
        if whole or changed != self._reported or now >= self._due:
            self._reported, self._due = changed, now + REPORT_PERIOD
            self._on_mission(run.describe(phase, text, whole=whole))

    def _say(self, text: str, *, caution: bool = False) -> None:
        severity: Severity = "caution" if caution else "info"
        self._on_event(Event(time=self._clock.now(), kind="mission", severity=severity, text=text))


def make_runner(
    bus: Bus,
    clock: Clock,
    limits: MissionLimits,
    control: ControlNode,
    supervisor: Supervisor,
    vision: Vision,
    parameters: Registry,
    on_event: Callable[[Event], None],
) -> MissionRunner:
    """Return the runner of a robot's missions, which publishes them on the bus."""
    senses = MissionSenses(bus, clock, control, supervisor.detector, vision)
    publish = partial(bus.publish_document, MISSION)
    return MissionRunner(clock, limits, senses, parameters, supervisor.stop, publish, on_event)
