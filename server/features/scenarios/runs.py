"""Runs scenarios one after the other; those in simulated time may wait in a queue."""

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Protocol

from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import Scenario, read_scenario
from server.features.scenarios.run import RunCancelledError, RunFailedError, RunRecord
from server.features.scenarios.schemas import BoardKind, End, EndedRun, Place, QueuedRun, ScenarioState
from server.features.sessions.recorder import RecordingRefusedError
from server.platform.store import StoreError
from server.stream.bridge import RuntimeSilentError

log = logging.getLogger(__name__)

QUEUE_MAX = 20
NOTIFY_SECONDS = 0.25


class ScenarioExecutor(Protocol):
    """Where a scenario is performed."""

    def check(self, scenario: Scenario) -> None:
        """Raises RefusedError with all reasons why it cannot be performed here now."""

    async def perform(self, run: RunRecord) -> None:
        """From its beginning to its end.

        Raises RunCancelledError, RunFailedError, and what it meets on its way.
        """


class ScenarioRunner:
    """At most one scenario runs at a time; `notify` reports progress."""

    def __init__(
        self, live: ScenarioExecutor, simulated: ScenarioExecutor, notify: Callable[[dict[str, Any]], None]
    ) -> None:
        self._executors: dict[Place, ScenarioExecutor] = {"live": live, "simulated": simulated}
        self._notify = notify
        self._number = 0
        self._active: RunRecord | None = None
        self._queue: deque[RunRecord] = deque()
        self._last: EndedRun | None = None
        self._task: asyncio.Task[None] | None = None

    @property
    def active(self) -> RunRecord | None:
        """The run that is on."""
        return self._active

    def state(self) -> ScenarioState:
        """The active run, the queue and the last run."""
        return ScenarioState(
            active=None if self._active is None else self._active.describe(),
            queued=[
                QueuedRun(run=run.number, name=run.scenario.name, title=run.scenario.title)
                for run in self._queue
            ],
            last=self._last,
        )

    def start(self, text: str, place: Place, board: BoardKind, who: str = "") -> int:
        """Run a scenario, or let it wait for its turn; its number. Raises ConfigError, RefusedError."""
        scenario = read_scenario(text)
        if place == "live" and self._active is not None:
            raise RefusedError(
                f"“{self._active.scenario.title}” is being run. Wait for its end, or cancel it."
            )
        if len(self._queue) >= QUEUE_MAX:
            raise RefusedError(f"{QUEUE_MAX} scenarios wait already. Wait until some have ended.")
        self._executors[place].check(scenario)
        self._number += 1
        run = RunRecord(self._number, scenario, text, place, board, who)
        self._queue.append(run)
        if self._task is None or self._task.done():
            # Now, and not when the task begins: whoever asks next must find it occupied.
            self._active = self._queue.popleft()
            self._task = asyncio.create_task(self._work())
        self.announce()
        return run.number

    def cancel(self) -> None:
        """End what runs, in order, and forget what waits; what was recorded is kept."""
        self._queue.clear()
        if self._active is not None:
            self._active.cancel("It was cancelled.")
        self.announce()

    def see_stop(self) -> None:
        """Somebody said STOP to the robot: that ends what runs on it."""
        if self._active is not None and self._active.place == "live":
            self._active.cancel("Somebody pressed STOP.")

    async def wait(self) -> None:
        """Wait until nothing runs."""
        if self._task is not None:
            await asyncio.wait([self._task])

    async def close(self) -> None:
        """Cancel everything, and wait for its end."""
        self.cancel()
        await self.wait()

    def announce(self) -> None:
        """Tell the state."""
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
            state, problem = "failed", f"The server made a mistake ({why!r}); its log says more."
        return run.end(state, problem)

    async def _announce_regularly(self) -> None:
        while True:
            self.announce()
            await asyncio.sleep(NOTIFY_SECONDS)
