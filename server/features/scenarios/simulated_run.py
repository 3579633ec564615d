"""A scenario in simulated time, in a process of low priority, and the recording of its blocks.

`python -m robot_runtime.experiments.scenario` reads the text from its standard input, and writes messages to
its standard output: `u32 size | u8 kind | bytes` (little-endian), kind 0 a JSON object, kind 1 blocks.
"""

import asyncio
import contextlib
import json
import os
import signal
import sys
from asyncio.subprocess import PIPE, Process
from collections import deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from struct import Struct
from typing import Any

from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.transport.blocks import Block, read_blocks
from server.features.scenarios.recording import begin, describe_session, mark
from server.features.scenarios.run import RunFailedError, RunRecord
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.exit_status import describe_status
from server.recording.recorder import Recorder

HEADER = Struct("<IB")
EVENTS, BLOCKS = 0, 1
MESSAGE_BYTES_MAX = 16_000_000
FLUSH_BYTES = 2_000_000
ERROR_LINES = 5
END_SECONDS = 10.0
"""Time after which a terminated process is killed."""


class ScenarioClock:
    """The scenario's own time, s since its beginning."""

    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        """Return the time, s."""
        return self.time


class SimulatedExecutor:
    """Executor of scenarios in simulated time, each in its own process."""

    def __init__(self, settings: Settings, store: Store, notices: Notices) -> None:
        self._settings = settings
        self._store = store
        self._notices = notices

    def check(self, scenario: Scenario) -> None:
        """Accept every scenario."""

    async def perform(self, run: RunRecord) -> None:
        """Perform a run. Raise RunCancelledError, RunFailedError, StoreError, OSError."""
        clock = ScenarioClock()
        recorder = Recorder(self._store, clock, self._notices, lambda: None)
        run.phase = "preparing"
        try:
            async with _process(run, self._settings) as (process, errors):
                await _Playback(run, self._settings, self._store, recorder, clock).take(process)
                status = await process.wait()
                run.check()
                if status != 0:
                    output = " / ".join(errors)
                    raise RunFailedError(f"The simulation {describe_status(status)}. {output}".strip())
        finally:
            run.phase = "ending"
            if recorder.session is not None:
                await asyncio.shield(asyncio.create_task(recorder.stop(recorder.session.id)))


class _Playback:
    """The storage of a process's events and samples."""

    def __init__(
        self, run: RunRecord, settings: Settings, store: Store, recorder: Recorder, clock: ScenarioClock
    ) -> None:
        self._run = run
        self._settings = settings
        self._store = store
        self._recorder = recorder
        self._clock = clock
        self._gathered = 0
        self._ended: dict[str, Any] | None = None

    async def take(self, process: Process) -> None:
        """Store everything up to the process's end. Raise RunFailedError, StoreError."""
        assert process.stdout is not None
        try:
            while (message := await _read(process.stdout)) is not None:
                kind, data = message
                if kind == EVENTS:
                    await self._take_event(json.loads(data))
                elif kind == BLOCKS:
                    await self._take_blocks(read_blocks(data), len(data))
        except (ValueError, LayoutError, KeyError, TypeError, asyncio.IncompleteReadError) as problem:
            if not isinstance(problem, asyncio.IncompleteReadError):
                raise RunFailedError(
                    f"The simulation sent a message that is not valid: {problem!r}"
                ) from problem
        if self._ended and self._ended.get("problem"):
            self._run.remarks.append(str(self._ended["problem"]))

    async def _take_event(self, event: dict[str, Any]) -> None:
        run = self._run
        if "time" in event:
            run.elapsed = self._clock.time = float(event["time"])
        match event.get("event"):
            case "started":
                row = describe_session(self._settings, self._clock, run, "null")
                row.firmware = str(event.get("firmware", ""))
                row.software = str(event.get("software", ""))
                await begin(self._recorder, self._store, run, row)
            case "marker" if run.session is not None:
                await mark(self._store, run.session, float(event["time"]), str(event["text"]))
            case "ended":
                self._ended = event
            case "refused":
                raise RunFailedError(" ".join(map(str, event["problems"])))

    async def _take_blocks(self, blocks: list[Block], size: int) -> None:
        for block in blocks:
            self._recorder.add(block)
        self._gathered += size
        if self._gathered >= FLUSH_BYTES:
            self._gathered = 0
            await self._recorder.flush()


@asynccontextmanager
async def _process(run: RunRecord, settings: Settings) -> AsyncIterator[tuple[Process, deque[str]]]:
    """Run the process of a scenario; `errors` are the last lines of its standard error."""
    command = [
        sys.executable,
        "-m",
        "robot_runtime.experiments.scenario",
        "--board",
        run.board,
        "--craft",
        str(settings.craft_file),
    ]
    process = await asyncio.create_subprocess_exec(
        *command,
        stdin=PIPE,
        stdout=PIPE,
        stderr=PIPE,
        start_new_session=True,
        limit=MESSAGE_BYTES_MAX,
        env={**os.environ, "MUCAT_BUILD": str(settings.build)},
    )
    errors: deque[str] = deque(maxlen=ERROR_LINES)
    tasks = [
        asyncio.create_task(_write_input(process, run.text)),
        asyncio.create_task(_collect_errors(process, errors)),
        asyncio.create_task(_end_when_cancelled(process, run)),
    ]
    try:
        yield process, errors
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        if process.returncode is None:
            _signal(process, signal.SIGKILL)
            # `wait` would never return where a pipe is full, and nobody reads it any more.
            await process.communicate()


async def _write_input(process: Process, text: str) -> None:
    assert process.stdin is not None
    with contextlib.suppress(ConnectionError):
        process.stdin.write(text.encode())
        await process.stdin.drain()
    process.stdin.close()


async def _collect_errors(process: Process, errors: deque[str]) -> None:
    assert process.stderr is not None
    async for line in process.stderr:
        errors.append(line.decode(errors="replace").strip())


async def _end_when_cancelled(process: Process, run: RunRecord) -> None:
    await run.cancelled()
    _signal(process, signal.SIGTERM)
    await asyncio.sleep(END_SECONDS)
    _signal(process, signal.SIGKILL)


def _signal(process: Process, number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, number)


async def _read(stream: asyncio.StreamReader) -> tuple[int, bytes] | None:
    """Return one message; None after the last.

    Raise ValueError, and IncompleteReadError for a truncated one.
    """
    try:
        size, kind = HEADER.unpack(await stream.readexactly(HEADER.size))
    except asyncio.IncompleteReadError as problem:
        if problem.partial:
            raise
        return None
    if size > MESSAGE_BYTES_MAX:
        raise ValueError(f"a message of {size} bytes")
    return kind, await stream.readexactly(size)
