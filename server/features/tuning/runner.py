"""The runner of tuning experiments: it starts, collects, evaluates and stores them."""

import asyncio
import json
import logging
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from math import degrees, inf
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.commands import EndExperimentCommand
from robot_runtime.contract.documents import ExperimentPhase
from robot_runtime.contract.topics import EXPERIMENT
from robot_runtime.errors import RefusedError
from robot_runtime.transport.blocks import Block
from server.driving.changes import Changes
from server.features.tuning.curve import SampleBuffer
from server.features.tuning.figure_definitions import is_angle
from server.features.tuning.runs import TuningStore
from server.features.tuning.schemas import (
    ENDED,
    ActiveTuning,
    ControllerInForce,
    RelayStart,
    RunState,
    StepStart,
    TuningRun,
    TuningState,
)
from server.platform.errors import explain_internal_error
from server.platform.runs import require_run
from server.platform.store import StoreError
from server.processes.managed_process import Notify
from server.stream.bridge import Bridge, RuntimeSilentError

log = logging.getLogger(__name__)

SILENCE_SECONDS = 5.0
"""s without a report of the experiment, which sends two per second, after which it has failed."""
CHECK_SECONDS = 1.0
PID = "pid"
SERVER = "the server"


@dataclass(slots=True)
class _Active:
    run: int
    experiment: StepStart | RelayStart
    samples: SampleBuffer
    began: float
    since: float
    heard: float
    phase: ExperimentPhase = "settling"
    progress: float = 0.0
    cycles: int = 0
    text: str = ""
    starts: dict[str, float] = field(default_factory=dict)
    """The start of each phase, s, steady clock."""

    @property
    def over(self) -> bool:
        return self.phase in ENDED

    def describe(self) -> ActiveTuning:
        """Return the run as sent to the pages."""
        return ActiveTuning(
            run=self.run,
            kind=self.experiment.kind,
            loop=self.experiment.loop,
            phase=self.phase,
            began=self.began,
            since=self.since,
            progress=round(self.progress, 3),
            cycles=self.cycles,
            settings=self.experiment.model_dump(),
        )


class TuningRunner:
    """Runner of one experiment at a time; `notify` reports progress, `occupied` a reason against a start."""

    def __init__(
        self,
        runs: TuningStore,
        bridge: Bridge,
        changes: Changes,
        clock: Clock,
        notify: Callable[[dict[str, Any]], None],
        notice: Notify,
        occupied: Callable[[], str | None],
    ) -> None:
        self.runs = runs
        self._bridge = bridge
        self._changes = changes
        self._clock = clock
        self._notify = notify
        self._notice = notice
        self._occupied = occupied
        self._active: _Active | None = None
        self._starting = False
        self._orphaned = False
        self._last: TuningRun | None = None
        self._ending: asyncio.Task[None] | None = None

    def state(self) -> TuningState:
        """Return the active run and the last one."""
        active = None if self._active is None else self._active.describe()
        return TuningState(active=active, last=self._last)

    async def start(self, who: str, experiment: StepStart | RelayStart) -> int:
        """Start a run and return its number. Raise RefusedError, RuntimeSilentError, StoreError."""
        self._check()
        self._starting = True
        try:
            # The last state that the server received may be older than a change of the controller.
            force, limits = _in_force(await self._bridge.query("state"), experiment.loop)
            run = await self.runs.begin(experiment, _name(experiment, force), force, limits)
            now = self._clock.now()
            self._active = _Active(
                run, experiment, SampleBuffer(experiment.loop), began=now, since=now, heard=now
            )
            try:
                await self._changes.command(who, experiment.command(run))
            except BaseException:
                self._active = None
                await asyncio.shield(self.runs.forget(run))
                raise
        finally:
            self._starting = False
        self.announce()
        return run

    async def delete(self, run: int) -> None:
        """Remove a run for good.

        Raise SessionStateError while it runs, UnknownTuningRunError, StoreError.
        """
        await self.runs.delete(run)
        if self._last is not None and self._last.id == run:
            self._last = None
            self.announce()

    async def stop(self, run: int | None = None) -> None:
        """Stop the active run, or only this one; its curve so far is stored.

        Raise RefusedError if nothing runs, RunOverError, RuntimeSilentError.
        """
        require_run(run, None if self._active is None else self._active.run, "experiment")
        if self._active is None:
            raise RefusedError("No experiment is running.")
        await self._changes.command(SERVER, EndExperimentCommand())

    def see(self, block: Block) -> None:
        """Process a block from the robot."""
        active = self._active
        if block.topic is EXPERIMENT:
            for document in json.loads(block.payload):
                self._take_progress(document)
        elif active is not None and not active.over:
            active.samples.see(block)

    def announce(self) -> None:
        """Send the state to the pages."""
        self._notify({"op": "tuning", **json.loads(self.state().model_dump_json())})

    async def run(self) -> None:
        """Check every second that the active run still reports; end orphaned experiments."""
        while True:
            await asyncio.sleep(CHECK_SECONDS)
            active = self._active
            if active is not None and not active.over and self._clock.now() - active.heard > SILENCE_SECONDS:
                active.phase = "failed"
                active.text = "The robot's runtime no longer reports on it."
                self._end(active)
            if self._orphaned:
                self._orphaned = False
                with suppress(RefusedError, RuntimeSilentError):
                    await self._changes.command(SERVER, EndExperimentCommand())

    async def close(self) -> None:
        """Stop the active run, and store its measurements."""
        active = self._active
        if active is not None and not active.over:
            with suppress(RefusedError, RuntimeSilentError):
                await self._changes.command(SERVER, EndExperimentCommand())
            active.phase, active.text = "stopped", "The server ended."
            self._end(active)
        if self._ending is not None:
            await asyncio.wait([self._ending])

    def _check(self) -> None:
        if self._active is not None or self._starting:
            raise RefusedError("An experiment is already running. Wait for its end, or stop it first.")
        if (why := self._occupied()) is not None:
            raise RefusedError(why)

    def _take_progress(self, document: dict[str, Any]) -> None:
        active = self._active
        if active is None or document["number"] != active.run:
            # An experiment of a killed server, or of a start whose answer was lost.
            self._orphaned = document["phase"] not in ENDED
            return
        if active.over:
            return
        active.heard = self._clock.now()
        active.phase, active.since, active.progress = (
            document["phase"],
            document["since"],
            document["progress"],
        )
        active.cycles, active.text = document["cycles"], document["text"]
        active.starts.setdefault(active.phase, active.since)
        active.began = min(active.starts.values())
        if document["phase"] in ENDED:
            self._end(active)
        self.announce()

    def _end(self, active: _Active) -> None:
        self._ending = asyncio.create_task(self._finish(active))

    async def _finish(self, active: _Active) -> None:
        state: RunState = "failed" if active.phase not in ("complete", "stopped") else active.phase
        problem = active.text
        try:
            # NumPy is loaded at its first use.
            from server.features.tuning.evaluation import measure_run

            results, curve, problem = await asyncio.to_thread(
                measure_run, active.experiment, active.samples, active.starts, state, problem
            )
            state = "failed" if problem and state == "complete" else state
            await self.runs.end(active.run, state, problem, results, curve)
            self._last = await asyncio.to_thread(self.runs.detail, active.run)
            text = {"complete": "is complete", "stopped": "was stopped", "failed": "failed"}[state]
            self._notice("tuning", "info", f"“{self._last.name}” {text}. {problem}".strip())
        except StoreError as why:
            self._notice("tuning", "caution", f"The run could not be stored: {why}.")
        except Exception as why:
            log.exception("a tuning run could not be measured")
            text = explain_internal_error(why)
            curve = active.samples.curve.between(-inf, inf, active.began)
            with suppress(StoreError):
                await self.runs.end(active.run, "failed", text, {}, curve)
                self._last = await asyncio.to_thread(self.runs.detail, active.run)
            self._notice("tuning", "caution", f"The run could not be measured. {text}")
        finally:
            self._active = None
            self.announce()


def _name(experiment: StepStart | RelayStart, force: ControllerInForce) -> str:
    if experiment.kind == "step":
        start, target = (_format(value, experiment.loop) for value in (experiment.start, experiment.target))
        return f"{force.title}, {start} to {target}"
    return f"Relay ±{100 * experiment.amplitude:g} % at {_format(experiment.set_point, experiment.loop)}"


def _format(value: float, loop: str) -> str:
    return f"{degrees(value):.0f}°" if is_angle(loop) else f"{value:g} m"


def _in_force(
    state: Mapping[str, Any], loop: str
) -> tuple[ControllerInForce, dict[str, tuple[float, float]]]:
    """Return the loop's controller, and the limits of its PID's gains.

    Raise RefusedError if no run can start on it.
    """
    if state["mode"] != "automatic":
        raise RefusedError(f"The robot is {state['mode']}. Arm it, in automatic, before an experiment.")
    described = next((entry for entry in state["loops"] if entry["name"] == loop), None)
    if described is None:
        raise RefusedError(f"This robot's runtime has no loop {loop!r}.")
    choices = {choice["name"]: choice for choice in described["controllers"]}
    chosen = choices[described["controller"]]
    force = ControllerInForce(
        controller=chosen["name"],
        title=chosen["title"],
        gains={gain["name"]: gain["value"] for gain in chosen["gains"]},
    )
    pid = choices.get(PID, {"gains": []})
    return force, {gain["name"]: (gain["minimum"], gain["maximum"]) for gain in pid["gains"]}
