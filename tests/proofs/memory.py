"""Memory of the runtime and of the server over an hour: `python -m tests.proofs.memory 60`; 1 for growth.

Each is loaded in a process of its own, as fast as the computer goes. The runtime dives in simulated time,
armed and stopped each minute, with cards, current and waves. The server takes an hour's messages, records a
session each minute, replays, compares and removes it, while pages come and go and commands pass. Once it is
warm, memory must stay: it is weighed each minute (`tests.proofs.scales`).
"""

import asyncio
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import httpx
from websockets.exceptions import ConnectionClosed

from bench.dive import Dive
from robot_runtime.config import RobotConfig
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.transport import replay_cache
from server.analysis import result_cache, samples
from server.analysis.comparer import Comparer
from server.analysis.schemas import ComparisonQuery
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from server.stream import hub
from server.stream.hub import Hub
from tests.exports import export_session
from tests.proofs.scales import ANONYMOUS, IN_USE, Limit, Scales, judge
from tests.server.serving import Served, serve
from tests.server.waiting import until
from tests.shell import ShellAuth
from tests.stack import ROOT

MINUTE = 60.0
STEP = 1.0
"""s of messages that are published at once."""
SMALL_BYTES, SMALL_MESSAGES, SMALL_RESULTS = 20_000, 40, 2
"""Buffers and caches of this size are full after a minute or two. With their own, which take up to an hour,
filling them would be taken for growth."""
PAGES = 3
COMMANDS = 20
EXPORT_EVERY = 10
"""minutes; an export is made by a process of its own."""

HEAD = """
name = "memory"
title = "Memory"
description = "A minute again and again."
duration = {seconds}
[scene]
kind = "natural"
depth = 4.0
[control]
controller = "pid"
[vision]
camera = "card"
"""
EVENTS = (
    (1, 'do = "acknowledge"'),
    (2, 'do = "arm"'),
    (10, 'do = "card"\ncolour = "yellow"'),
    (15, 'do = "current"\nnorth = 0.1\neast = 0.05\nturning = 0.05'),
    (20, 'do = "card"'),
    (30, 'do = "waves"\namplitude = 0.05\nperiod = 2.5\ndirection = 1.0'),
    (45, 'do = "waves"\namplitude = 0'),
    (55, 'do = "stop"'),
)


LIMITS: Mapping[str, Mapping[str, Limit]] = {
    "runtime": {IN_USE: Limit(1, 0.1, 0.02), ANONYMOUS: Limit(1, 0.1, 0.02)},
    "server": {IN_USE: Limit(6, 0.5, 0.02), ANONYMOUS: Limit(6, 3.0, 0.05)},
}


class _Minutes:
    """Hears a run, and weighs after each minute of it."""

    def __init__(self, scales: Scales) -> None:
        self.blocks_heard = 0
        self._scales = scales

    def blocks(self, data: bytes) -> None:
        self.blocks_heard += len(data)

    def event(self, event: str, **more: Any) -> None:
        if event == "marker" and "refused" in more["text"]:
            raise AssertionError(more["text"])
        if event == "progress" and more["time"] > 0 and more["time"] % MINUTE == 0:
            self._scales.weigh()


def load_runtime(minutes: int) -> dict[str, list[float]]:
    """MB of each kind after each minute of a dive in simulated time."""
    events = (
        f"[[events]]\nat = {minute * MINUTE + at}\n{what}\n"
        for minute in range(minutes)
        for at, what in EVENTS
    )
    scenario = read_scenario(HEAD.format(seconds=minutes * MINUTE) + "".join(events))
    scales = Scales()
    listener = _Minutes(scales)
    ScenarioRun(scenario, boards()["host"], listener).perform(lambda _: {})
    assert listener.blocks_heard > minutes * MINUTE * 1000
    return scales.held


def load_server(minutes: int) -> dict[str, list[float]]:
    """MB of each kind after each minute of messages and of what people do."""
    hub.HISTORY_TOPIC_BYTES = samples.CACHE_BYTES = replay_cache.BYTES_MAX = SMALL_BYTES
    result_cache.RESULTS_MAX = SMALL_RESULTS
    hub.ROWS_MESSAGES = hub.DOCUMENTS_MESSAGES = SMALL_MESSAGES
    scales = Scales()
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        data = DataFolder(Path(name) / "data")
        make_folders(data)
        settings = Settings(
            data=data,
            config=ROOT / "robot.toml",
            robot=RobotConfig(name="tested"),
            page=ROOT / "server" / "page",
        )
        asyncio.run(_serve_minutes(settings, minutes, scales))
    return scales.held


async def _serve_minutes(settings: Settings, minutes: int, scales: Scales) -> None:
    async with serve(settings) as served:
        day = _Day(served, minutes)
        page = asyncio.create_task(day.watch())
        await until(lambda: served.get(Hub).clients == 1, "the page")
        for minute in range(minutes):
            await day.live_through(minute)
            scales.weigh()
        page.cancel()
        await asyncio.gather(page, return_exceptions=True)


class _Day:
    """The events in the life of a server, minute by minute."""

    def __init__(self, served: Served, minutes: int) -> None:
        self._served = served
        self._start = time.monotonic()
        self._dive = Dive(self._start, minutes * MINUTE, 1)
        self._sent = 0
        self._before: int | None = None
        # As the process has that compares for a server; here it is weighed too.
        self._comparer = Comparer(served.get(Store))

    async def live_through(self, minute: int) -> None:
        """A minute: the robot sends, and people record, watch, command, look back and tidy up."""
        begin = self._start + minute * MINUTE
        session = (await self._post("/sessions", {"name": f"minute {minute}"}))["id"]
        await self._send(begin, begin + MINUTE / 2)
        for _ in range(PAGES):
            await self._visit()
        await self._served.take_control()
        for _ in range(COMMANDS):
            await self._post("/robot/commands/arm")
            await self._post("/robot/stop")
        await self._send(begin + MINUTE / 2, begin + MINUTE)
        await self._post(f"/sessions/{session}/stop")
        await self._look_back(session)
        if minute % EXPORT_EVERY == 0:
            await asyncio.to_thread(self._export, session)
        if self._before is not None:
            await self._remove(self._before)
        self._before = session
        for heard in (self._served.runtime.asked, self._served.runtime.epochs):
            heard.clear()

    async def watch(self) -> None:
        """A page that stays, and reads."""
        async with self._served.connect() as socket:
            with suppress(ConnectionClosed):
                async for _ in socket:
                    pass

    async def _visit(self) -> None:
        """A page that comes, reads what there is and goes away."""
        async with self._served.connect() as socket:
            await socket.send(json.dumps({"op": "ping", "id": 1}))
            while True:
                message = await asyncio.wait_for(socket.recv(), 10)
                if isinstance(message, str) and json.loads(message)["op"] == "pong":
                    return

    async def _send(self, begin: float, end: float) -> None:
        totals, depth = self._served.container.services.get(Hub).rows, BY_NAME["depth"].id
        for step in range(round((end - begin) / STEP)):
            blocks = list(self._dive.until(begin + (step + 1) * STEP))
            self._sent += sum(block.count for block in blocks if block.topic.id == depth)
            self._served.runtime.publish(*blocks)
            await until(lambda: totals.totals.get(depth, 0) == self._sent, "what was sent")

    async def _look_back(self, session: int) -> None:
        for start, end in ((0.0, 5.0), (20.0, 25.0), (50.0, 60.0)):
            await self._get(f"/sessions/{session}/blocks", start=start, end=end, history=60.0)
        for path in (f"/sessions/{session}/timeline", "/sessions", "/storage", "/health"):
            await self._get(path)
        both = [recording for recording in (session, self._before) if recording is not None]
        compared = ComparisonQuery(sessions=both, signals=["depth.depth"])
        await self._post("/compare", compared.model_dump(mode="json"))
        await asyncio.to_thread(self._comparer.compare, compared)

    def _export(self, session: int) -> None:
        settings = self._served.settings
        base = f"{settings.scheme}://127.0.0.1:{settings.server.port}/api"
        with httpx.Client(base_url=base, auth=ShellAuth(settings.data), timeout=30) as client:
            assert len(export_session(client, session).content) > 100_000

    async def _remove(self, session: int) -> None:
        (await self._served.api.delete(f"/sessions/{session}")).raise_for_status()
        await self._post(f"/sessions/{session}/purge")

    async def _get(self, path: str, **query: float) -> None:
        (await self._served.api.get(path, params=query)).raise_for_status()

    async def _post(self, path: str, body: object = None) -> Any:
        answer = await self._served.api.post(path, json=body)
        answer.raise_for_status()
        return answer.json() if answer.content else None


def measure(part: str, minutes: int) -> dict[str, list[float]]:
    """MB of each kind after each minute, from a process of its own."""
    command = [sys.executable, "-m", "tests.proofs.memory", part, str(minutes)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    answer: dict[str, list[float]] = json.loads(done.stdout)
    return answer


def main() -> int:
    """Exit status."""
    if len(sys.argv) > 2:
        load = {"runtime": load_runtime, "server": load_server}[sys.argv[1]]
        print(json.dumps(load(int(sys.argv[2]))))
        return 0
    minutes = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    grown = False
    for part, limits in LIMITS.items():
        held = measure(part, minutes)
        for kind, sizes in held.items():
            print(f"{part}, {kind}: {', '.join(f'{size:.2f}' for size in sizes)} MB")
        problem = judge(limits, held)
        grown |= bool(problem)
        print(f"{part}: {problem or 'memory does not grow'}.")
    return 1 if grown else 0


if __name__ == "__main__":
    sys.exit(main())
