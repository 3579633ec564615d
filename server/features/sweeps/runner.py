"""Runs sweeps, one after the other, each in a process beside the server."""

import asyncio
import json
import logging
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from time import time
from typing import Any

from robot_runtime.contract.craft import read_craft
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import DEFAULT_CRAFT
from robot_runtime.experiments.sweep.document import Sweep
from server.features.sweeps.config import SweepsConfig
from server.features.sweeps.order import SweepOrder, read_document, reopen
from server.features.sweeps.results import SweepProgress
from server.features.sweeps.run_task import RunOutcome, identify
from server.features.sweeps.schemas import SweepBest, SweepState, SweepSummary
from server.features.sweeps.store import StoredRun, SweepStore
from server.library.scenarios import scenario_texts
from server.platform.errors import explain_internal_error
from server.platform.models import SweepRow
from server.platform.settings import Settings
from server.platform.store import StoreError
from server.processes.side_process import SideProcess

log = logging.getLogger(__name__)

QUEUE_MAX = 20
KEEP_SECONDS = 0.5
"""Between two commits of runs that are done."""
NOTIFY_SECONDS = 0.25


@dataclass(frozen=True, slots=True)
class PlannedSweep:
    """A sweep with its text, and the texts of its scenario and of the robot's craft file."""

    text: str
    sweep: Sweep
    scenario_text: str
    craft: str


@dataclass(slots=True)
class ActiveSweep:
    """The sweep that runs."""

    number: int
    sweep: Sweep
    progress: SweepProgress
    workers: int = 0
    notice: str = ""
    computed: int = 0
    seconds: float = 0.0
    """Sum of the times that the computed runs took, s."""
    last: float = 0.0
    """End of the last computed run (loop's time, s)."""
    runs: list[StoredRun] = field(default_factory=list)
    """Done, and not stored yet."""

    def remaining(self, now: float) -> float | None:
        """Return the s until the end, by the time of a run; None before the first and without workers.

        Not by the time since the start: the first runs end together, and much later than the workers began.
        """
        if not self.computed or not self.workers:
            return None
        each = self.seconds / self.computed / self.workers
        return (self.sweep.runs - self.progress.done) * each - min(now - self.last, each)


class SweepRunner:
    """Runner of one sweep at a time, the others waiting; `notify` reports progress."""

    def __init__(
        self,
        settings: Settings,
        config: SweepsConfig,
        store: SweepStore,
        notify: Callable[[dict[str, Any]], None],
    ) -> None:
        self._settings = settings
        self._config = config
        self._store = store
        self._notify = notify
        self._queue: deque[int] = deque()
        self._active: ActiveSweep | None = None
        self._starting: int | None = None
        self._task: asyncio.Task[None] | None = None
        self._performing: asyncio.Task[None] | None = None
        self._ended: int | None = None
        self._closing = False

    async def recover(self) -> None:
        """Mark the sweeps of a killed server, and remove figures that nobody needs. Raise StoreError."""
        await self._store.interrupt()
        identity = await asyncio.to_thread(identify, self._settings.build)
        await self._store.forget(identity.software)

    def read(self, text: str) -> PlannedSweep:
        """Return the sweep of a text, checked against the library and craft of now. Blocks.

        Raise ConfigError.
        """
        scenarios = scenario_texts(self._settings.data.scenarios)
        craft = _read_text(self._settings.craft_file)
        sweep = read_document(text, scenarios, read_craft(craft).craft if craft else DEFAULT_CRAFT)
        return PlannedSweep(text, sweep, scenarios[sweep.scenario], craft)

    async def start(self, planned: PlannedSweep, who: str) -> int:
        """Start or queue a sweep, and return its number. Raise RefusedError, StoreError."""
        self._require_room()
        sweep = planned.sweep
        number = await self._store.add(
            SweepRow(
                name=sweep.name,
                title=sweep.title,
                scenario=sweep.scenario,
                text=planned.text,
                scenario_text=planned.scenario_text,
                craft=planned.craft,
                who=who,
                state="waiting",
                runs=sweep.runs,
                best_figure=sweep.figures.best,
                parameters=json.dumps([parameter.name for parameter in sweep.parameters]),
                made=time(),
            )
        )
        self._enqueue(number)
        await self.announce()
        return number

    async def resume(self, number: int) -> None:
        """Go on with a sweep that ended before all its runs were done.

        Raise UnknownSweepError, RefusedError, StoreError.
        """
        row = await asyncio.to_thread(self._store.find, number)
        if number in self._all():
            raise RefusedError("This sweep runs, or waits for its turn.")
        if row.state == "complete" and not row.failed:
            raise RefusedError("All runs of this sweep are done.")
        self._require_room()
        await self._store.change(number, state="waiting", problem="", ended=None, done=0, failed=0, best="")
        self._enqueue(number)
        await self.announce()

    async def cancel(self, number: int) -> None:
        """End a sweep; what is done stays. Raise RefusedError, StoreError."""
        if number in self._queue:
            self._queue.remove(number)
            await self._store.change(number, state="cancelled", ended=time())
            self._ended = number
            await self.announce()
        elif number in self._all() and self._performing is not None:
            self._performing.cancel()
            await asyncio.wait([self._performing])
        else:
            raise RefusedError("This sweep does not run.")

    async def remove(self, number: int) -> None:
        """Remove a sweep that does not run. Raise UnknownSweepError, RefusedError, StoreError."""
        await asyncio.to_thread(self._store.find, number)
        if number in self._all():
            raise RefusedError("This sweep runs, or waits for its turn. Cancel it first.")
        await self._store.remove(number)
        if self._ended == number:
            self._ended = None
        await self.announce()

    async def close(self) -> None:
        """End everything; sweeps can be resumed after the next start."""
        self._closing = True
        self._queue.clear()
        if self._performing is not None:
            self._performing.cancel()
        await self.wait()

    async def wait(self) -> None:
        """Wait until nothing runs."""
        if self._task is not None:
            await asyncio.wait([self._task])

    def describe(self, row: SweepRow) -> SweepSummary:
        """Return a sweep as it stands."""
        active = self._active if self._active is not None and self._active.number == row.id else None
        now = asyncio.get_running_loop().time()
        best = None if not row.best else SweepBest.model_validate_json(row.best)
        return SweepSummary(
            id=row.id or 0,
            name=row.name,
            title=row.title,
            scenario=row.scenario,
            state=_state(row.state),
            problem=row.problem if active is None else active.notice,
            runs=row.runs,
            done=row.done if active is None else active.progress.done,
            failed=row.failed if active is None else active.progress.failed,
            made=row.made,
            started=row.started,
            ended=row.ended,
            remaining=None if active is None else active.remaining(now),
            workers=0 if active is None else active.workers,
            who=row.who,
            best_figure=row.best_figure,
            parameters=json.loads(row.parameters),
            best=best if active is None else active.progress.best,
        )

    async def announce(self) -> None:
        """Send the sweeps that run, wait, or ended last to the pages."""
        with suppress(StoreError):
            rows = await asyncio.to_thread(self._rows)
            self._notify({"op": "sweeps", "sweeps": [self.describe(row).model_dump() for row in rows]})

    def _rows(self) -> list[SweepRow]:
        ended = [] if self._ended is None else [self._ended]
        return self._store.some(list(dict.fromkeys([*self._all(), *ended])))

    def _all(self) -> list[int]:
        running = [] if self._starting is None else [self._starting]
        return [*running, *self._queue]

    def _require_room(self) -> None:
        if len(self._queue) >= QUEUE_MAX:
            raise RefusedError(f"{QUEUE_MAX} sweeps are waiting already. Wait until some have ended.")

    def _enqueue(self, number: int) -> None:
        self._queue.append(number)
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._work())

    async def _work(self) -> None:
        while self._queue:
            self._starting = number = self._queue.popleft()
            self._performing = asyncio.create_task(self._run(number))
            try:
                await asyncio.wait([self._performing])
            finally:
                self._starting = self._performing = None
                self._active = None
            self._ended = number
            await self.announce()

    async def _run(self, number: int) -> None:
        state: SweepState = "complete"
        problem = ""
        try:
            problem = await self._compute(number)
            state = "failed" if problem else "complete"
        except asyncio.CancelledError:
            state = "interrupted" if self._closing else "cancelled"
        except (StoreError, OSError) as why:
            state, problem = "failed", str(why)
        except Exception as why:
            log.exception("a sweep failed")
            state, problem = "failed", explain_internal_error(why)
        try:
            await self._keep(state=state, problem=problem, ended=time())
        except StoreError as why:
            log.warning("the end of a sweep is not stored: %s", why)

    async def _compute(self, number: int) -> str:
        """Compute a sweep. Return the reason why it could not go on; empty where all runs are done."""
        row = await asyncio.to_thread(self._store.find, number)
        order = SweepOrder(
            text=row.text,
            scenario=row.scenario_text,
            craft=row.craft,
            scheduler=self._config.scheduler,
            certificates=self._config.certificates,
            workers=self._config.workers,
        )
        sweep = reopen(row.text, row.scenario_text)
        self._active = active = ActiveSweep(number, sweep, SweepProgress(sweep))
        await self._keep(state="running", started=row.started or time())
        await self.announce()
        keeping = asyncio.create_task(self._keep_regularly())
        try:
            problem = await self._take(active, order)
        finally:
            keeping.cancel()
            with suppress(asyncio.CancelledError):
                await keeping
        if not problem and sweep.search is not None:
            # A search may find its end before the most of variants.
            await self._keep(runs=active.progress.done)
        return problem

    async def _take(self, active: ActiveSweep, order: SweepOrder) -> str:
        loop = asyncio.get_running_loop()
        with SideProcess(
            "server.features.sweeps",
            [str(self._settings.data.database_location)],
            order.model_dump_json().encode(),
            {"MUCAT_BUILD": str(self._settings.build)},
        ) as process:
            async for document in process.documents():
                if "run" in document:
                    run = _read_run(document)
                    active.progress.add(run)
                    active.runs.append(run)
                    active.notice = ""
                    if not document["stored"]:
                        active.last = loop.time()
                        active.computed += 1
                        active.seconds += run.outcome.seconds
                elif "problem" in document:
                    return str(document["problem"])
                elif "end" in document:
                    return ""
                active.workers = document.get("workers", active.workers)
                active.notice = document.get("notice", active.notice)
            return f"The process of the sweep {await process.describe_end()}"

    async def _keep_regularly(self) -> None:
        due = 0.0
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(NOTIFY_SECONDS)
            if loop.time() >= due:
                # What cannot be stored now is tried again.
                with suppress(StoreError):
                    await self._keep()
                due = loop.time() + KEEP_SECONDS
            await self.announce()

    async def _keep(self, **changes: Any) -> None:
        """Store the runs that are done since, the progress, and changes of the sweep. Raise StoreError."""
        active = self._active
        if active is None:
            if self._starting is not None and changes:
                await self._store.change(self._starting, **changes)
            return
        runs = active.runs[:]
        progress = {
            "done": active.progress.done,
            "failed": active.progress.failed,
            "best": "" if active.progress.best is None else active.progress.best.model_dump_json(),
        }
        await self._store.keep(active.number, identify(self._settings.build), runs, {**progress, **changes})
        del active.runs[: len(runs)]


def _read_run(document: dict[str, Any]) -> StoredRun:
    run = document["run"]
    return StoredRun(
        run["number"],
        run["variant"],
        run["seed"],
        tuple(run["values"]),
        RunOutcome(**document["outcome"]),
    )


def _read_text(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


def _state(state: str) -> SweepState:
    states: dict[str, SweepState] = {
        "running": "running",
        "waiting": "waiting",
        "complete": "complete",
        "cancelled": "cancelled",
        "failed": "failed",
    }
    return states.get(state, "interrupted")
