"""The runner of scenarios, one after the other; those in simulated time may wait in a queue."""

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Protocol

from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import Scenario
from server.features.scenarios.run import RunCancelledError, RunFailedError, RunRecord
from server.features.scenarios.schemas import BoardKind, End, EndedRun, Place, QueuedRun, ScenarioState
from server.platform.errors import explain_internal_error
from server.platform.runs import RunOverError, new_run
from server.platform.store import StoreError
from server.recording.recorder import RecordingRefusedError
from server.stream.bridge import RuntimeSilentError

log = logging.getLogger(__name__)

QUEUE_MAX = 20
NOTIFY_SECONDS = 0.25


class ScenarioExecutor(Protocol):
    """Executor of scenarios, on the robot or in simulated time."""

    def check(self, scenario: Scenario) -> None:
        """Raise RefusedError with all reasons against a run now."""

    async def perform(self, run: RunRecord) -> None:
        """Perform a run.

        Raise RunCancelledError, RunFailedError, RefusedError, RuntimeSilentError, StoreError, OSError.
        """


class ScenarioRunner:
    """Runner of at most one scenario at a time; `notify` reports progress."""

    def __init__(
        self, live: ScenarioExecutor, simulated: ScenarioExecutor, notify: Callable[[dict[str, Any]], None]
    ) -> None:
        self._executors: dict[Place, ScenarioExecutor] = {"live": live, "simulated": simulated}
        self._notify = notify
        self._active: RunRecord | None = None
        self._queue: deque[RunRecord] = deque()
        self._last: EndedRun | None = None
        self._task: asyncio.Task[None] | None = None

    @property
    def active(self) -> RunRecord | None:
        """The active run."""
        return self._active

    def state(self) -> ScenarioState:
        """Return the active run, the queue and the last run."""
        return ScenarioState(
            active=None if self._active is None else self._active.describe(),
            queued=[
                QueuedRun(run=run.run, name=run.scenario.name, title=run.scenario.title)
                for run in self._queue
            ],
            last=self._last,
        )

    def start(self, scenario: Scenario, text: str, timing: Place, board: BoardKind, who: str = "") -> str:
        """Start or queue the scenario of this text, and return its run. Raise RefusedError."""
        if timing == "live" and self._active is not None:
            raise RefusedError(f"“{self._active.scenario.title}” is running. Wait for its end, or cancel it.")
        if len(self._queue) >= QUEUE_MAX:
            raise RefusedError(f"{QUEUE_MAX} scenarios are waiting already. Wait until some have ended.")
        self._executors[timing].check(scenario)
        run = RunRecord(new_run(), scenario, text, timing, board, who)
        self._queue.append(run)
        if self._task is None or self._task.done():
            # Set here, before the task begins, so that the next request finds it active.
            self._active = self._queue.popleft()
            self._task = asyncio.create_task(self._work())
        self.announce()
        return run.run

    def cancel(self, run: str | None = None) -> None:
        """Cancel this run; without one cancel the active run and clear the queue. Recordings stay.

        Raise RunOverError if this run is neither active nor queued.
        """
        active = () if self._active is None else (self._active,)
        if run is not None and run not in (record.run for record in (*active, *self._queue)):
            raise RunOverError("run of a scenario")
        self._queue = deque(record for record in self._queue if run not in (None, record.run))
        if self._active is not None and run in (None, self._active.run):
            self._active.cancel("It was cancelled.")
        self.announce()

    def see_stop(self) -> None:
        """Cancel a live run after a STOP of the robot."""
        if self._active is not None and self._active.place == "live":
            self._active.cancel("STOP was pressed.")

    async def wait(self) -> None:
        """Wait until nothing runs."""
        if self._task is not None:
            await asyncio.wait([self._task])

    async def close(self) -> None:
        """Cancel everything, and wait for its end."""
        self.cancel()
        await self.wait()

    def announce(self) -> None:
        """Send the state to the pages."""
        self._notify({"op": "scenario", **self.state().model_dump()})

    async def _work(self) -> None:
        while self._active is not None:
            announcing = asyncio.create_task(self._announce_regularly())
            try:
                self._last = await self._perform(self._active)
            finally:
                announcing.cancel()
                with suppress(asyncio.CancelledError):
                    await announcing
                self._active = self._queue.popleft() if self._queue else None
                self.announce()

    async def _perform(self, run: RunRecord) -> EndedRun:
        state: End = "complete"
        problem = ""
        try:
            run.check()
            await self._executors[run.place].perform(run)
        except RunCancelledError as why:
            state, problem = "cancelled", str(why)
        except (
            RunFailedError,
            RefusedError,
            RecordingRefusedError,
            RuntimeSilentError,
            StoreError,
            OSError,
        ) as why:
            state, problem = "failed", str(why)
        except Exception as why:
            log.exception("a scenario failed")
            state, problem = "failed", explain_internal_error(why)
        return run.end(state, problem)

    async def _announce_regularly(self) -> None:
        while True:
            self.announce()
            await asyncio.sleep(NOTIFY_SECONDS)
