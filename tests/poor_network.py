"""`python -m tests.poor_network`: a page far from its server; prints JSON.

A round trip takes 0.2 s, each way loses 2 % of the packets, and for a while all of them. The robot's end
sends a dive at full rate, and pictures that the network cannot carry. Ages are exact: both hosts have one
clock.
"""

import asyncio
import json
import socket
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from statistics import quantiles
from typing import Any

import httpx
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException

from bench.dive import Dive
from robot_runtime.config import RobotConfig
from robot_runtime.contract.topics import BY_NAME, TIME, Kind
from robot_runtime.transport.blocks import Block, read_blocks, row
from server.driving.arbiter import ControlArbiter
from server.platform.server_config import ServerConfig
from server.platform.settings import DataFolder, Settings, make_folders
from tests.server.serving import Served, serve
from tests.server.sign_in.browsers import new_code
from tests.server.waiting import SECONDS, until
from tests.stack import ROOT
from tests.two_hosts import HERE, TwoHosts

DELAY, LOSS = 0.1, 0.02
"""s for each way; share of packets."""
STEP = 0.04
PICTURE_SECONDS, PICTURE_BYTES = 0.1, 60_000
WARM_SECONDS = 2.0
"""In which the past is received."""
WATCH_SECONDS, DRIVE_SECONDS, OUTAGE_SECONDS = 8.0, 4.0, 7.5
DRIVE_PERIOD = 0.1
COMMANDS = 8
SILENT_SECONDS = 4.0
"""s of silence after which a page opens another connection; as in frontend/src/live/socket.ts."""
RETRY_SECONDS = 0.25
FRESH = 1.5
"""s, the age of what a page shows again after an outage."""


@dataclass
class NetworkReport:
    """The observations of the page and of the robot's end."""

    ages: list[float] = field(default_factory=list)
    """s, of the newest depth in each message."""
    picture_ages: list[float] = field(default_factory=list)
    pictures_sent: int = 0
    stop_s: list[float] = field(default_factory=list)
    command_s: list[float] = field(default_factory=list)
    driven: int = 0
    passed: int = 0
    outage_released_s: float = 0.0
    outage_passed: int = 0
    outage_back_s: float = 0.0
    connections: list[int] = field(default_factory=list)
    """Made by the page before the outage, and after it."""
    packets: list[int] = field(default_factory=list)

    def figures(self) -> dict[str, Any]:
        """As the test judges them."""
        return vars(self) | {"ages": _spread(self.ages), "picture_ages": _spread(self.picture_ages)}


def _spread(ages: list[float]) -> dict[str, float]:
    cuts = quantiles(ages, n=20)
    return {"count": len(ages), "p50": cuts[9], "p95": cuts[18], "most": max(ages)}


class FarPage:
    """A page on the other host, which opens its socket again whenever it closes or falls silent."""

    def __init__(self, hosts: TwoHosts, served: Served, report: NetworkReport) -> None:
        self.connections = 0
        self.age = float("inf")
        """s, of the newest depth, when it came."""
        self.hello: dict[str, Any] = {}
        self.measuring = False
        self._served = served
        self._report = report
        # A socket stays on the host on which it was made, so one thread that lives there is enough.
        self._there = ThreadPoolExecutor(1, initializer=hosts.enter_there)
        self._origin = f"http://{HERE}:{served.settings.server.port}"
        self._api = httpx.Client(
            base_url=f"{self._origin}/api", headers={"origin": self._origin}, timeout=SECONDS
        )
        self._socket: ClientConnection | None = None

    async def pair(self) -> None:
        """Sign in."""
        code = await new_code(self._served, "operator")
        paired = await self.post("/access/pair", {"code": code, "name": "far"})
        self._api.headers["x-mucat"] = paired.json()["page_secret"]

    async def post(self, path: str, body: object = None) -> httpx.Response:
        """Ask the server for something, over the network."""
        headers = {"X-Mucat-Client": self.hello.get("client_key", "")}
        ask = lambda: self._api.post(path, json=body, headers=headers)  # noqa: E731 - shorter than a method
        return (await asyncio.get_running_loop().run_in_executor(self._there, ask)).raise_for_status()

    async def send(self, message: dict[str, Any]) -> None:
        """Say something over the socket."""
        assert self._socket is not None
        await self._socket.send(json.dumps(message))

    async def run(self) -> None:
        """Watch, for ever."""
        while True:
            with suppress(OSError, WebSocketException, TimeoutError):
                await self._watch()
            await asyncio.sleep(RETRY_SECONDS)

    async def _watch(self) -> None:
        address = (HERE, self._served.settings.server.port)
        make = lambda: socket.create_connection(address, SILENT_SECONDS)  # noqa: E731
        line = await asyncio.get_running_loop().run_in_executor(self._there, make)
        line.setblocking(False)
        cookie = "; ".join(f"{name}={value}" for name, value in self._api.cookies.items())
        async with connect(
            f"{self._origin.replace('http', 'ws', 1)}/api/live",
            sock=line,
            origin=self._origin,  # type: ignore[arg-type]
            additional_headers={"cookie": cookie},
            subprotocols=["mucat", self._api.headers["x-mucat"]],  # type: ignore[list-item]
            max_size=None,
            compression=None,
            proxy=None,
            ping_interval=None,
            open_timeout=SILENT_SECONDS,
            close_timeout=0.1,
        ) as self._socket:
            self.connections += 1
            while True:
                # Not wait_for: in Python 3.11 it ignores a cancellation that comes with the message.
                async with asyncio.timeout(SILENT_SECONDS):
                    message = await self._socket.recv()
                self._take(message)

    def _take(self, message: str | bytes) -> None:
        now = time.monotonic()
        if isinstance(message, str):
            answer = json.loads(message)
            if answer["op"] == "hello":
                self.hello = answer
            return
        for block in read_blocks(message):
            if block.topic.kind is Kind.PICTURE and self.measuring:
                self._report.picture_ages.append(now - TIME.unpack_from(block.payload)[0])
            elif block.topic.name == "depth":
                self.age = now - block.time_of(block.following - 1)
                if self.measuring:
                    self._report.ages.append(self.age)


class NetworkTrial:
    """A page that watches, drives, stops the robot, loses the network and comes back."""

    def __init__(self, hosts: TwoHosts, served: Served) -> None:
        self.report = NetworkReport()
        self._hosts = hosts
        self._served = served
        self._page = FarPage(hosts, served, self.report)
        self._sequence = 0

    async def play(self) -> None:
        """All of it."""
        await self._page.pair()
        tasks = [asyncio.create_task(work) for work in (self._robot(), self._page.run())]
        try:
            await until(lambda: self._page.age < FRESH, "the first fresh depth")
            await asyncio.sleep(WARM_SECONDS)
            await self._observe()
            await self._command()
            await self._drive()
            await self._lose_network()
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
        self.report.packets = [*self._hosts.packets]

    async def _robot(self) -> None:
        start = time.monotonic()
        dive = Dive(start, 120.0, 1)
        picture, due = 0, start
        while True:
            now = time.monotonic()
            blocks = [block for block in dive.until(now) if block.topic.kind is not Kind.PICTURE]
            if now >= due:
                due += PICTURE_SECONDS
                jpeg = row(now, bytes(PICTURE_BYTES))
                blocks.append(Block.of(BY_NAME["picture"], 1, picture, jpeg))
                picture += 1
                self.report.pictures_sent += self._page.measuring
            self._served.runtime.publish(*blocks)
            await asyncio.sleep(STEP)

    async def _observe(self) -> None:
        self._page.measuring = True
        await asyncio.sleep(WATCH_SECONDS)
        self._page.measuring = False

    async def _command(self) -> None:
        await self._page.post("/control/take")
        for _ in range(COMMANDS):
            self.report.stop_s.append(await self._time("stop", lambda: self._page.send({"op": "stop"})))
            ask = lambda: self._page.post("/robot/commands/acknowledge")  # noqa: E731
            self.report.command_s.append(await self._time("acknowledge", ask))

    async def _time(self, name: str, ask: Callable[[], Any]) -> float:
        """s until a command has reached the robot's end, and its answer the page where there is one."""
        asked = self._served.runtime.asked
        before = sum(request == name for request, _ in asked)
        began = time.monotonic()
        await ask()
        await until(lambda: sum(request == name for request, _ in asked) > before, name)
        return time.monotonic() - began

    async def _steer(self) -> None:
        self._sequence += 1
        command = {"op": "drive", "lease": self._served.container.services.get(ControlArbiter).lease.epoch}
        command |= {"sequence": self._sequence, "taken": time.monotonic(), "axes": [0, 0, 1, 0, 0, 0]}
        await self._page.send(command)

    async def _drive(self) -> None:
        end = time.monotonic() + DRIVE_SECONDS
        while time.monotonic() < end:
            await self._steer()
            self.report.driven += 1
            await asyncio.sleep(DRIVE_PERIOD)
        await asyncio.sleep(10 * DELAY)
        self.report.passed = len(self._served.runtime.driven)

    async def _lose_network(self) -> None:
        self._hosts.loss = 1.0
        began, before = time.monotonic(), self._page.connections
        await asyncio.sleep(2 * DELAY)
        passed = len(self._served.runtime.driven)
        with suppress(WebSocketException):
            await self._steer()
        lease = self._served.container.services.get(ControlArbiter).lease
        await until(lambda: lease.holder is None, "the lease to be given up")
        self.report.outage_released_s = time.monotonic() - began
        await asyncio.sleep(max(0.0, began + OUTAGE_SECONDS - time.monotonic()))
        self._page.age = float("inf")
        self._hosts.loss = LOSS
        back = time.monotonic()
        await until(lambda: self._page.age < FRESH, "fresh depths after the outage")
        self.report.outage_back_s = time.monotonic() - back
        self.report.outage_passed = len(self._served.runtime.driven) - passed
        self.report.connections = [before, self._page.connections]


async def run(hosts: TwoHosts, folder: Path) -> NetworkReport:
    """Return the report of a scenario."""
    data = DataFolder(folder / "data")
    make_folders(data)
    settings = Settings(
        data=data,
        config=ROOT / "robot.toml",
        robot=RobotConfig(name="tested"),
        sections={ServerConfig: ServerConfig(host="0.0.0.0", allowed_hosts=["127.0.0.1", HERE])},
        page=folder,
    )
    async with serve(settings) as served:
        scenario = NetworkTrial(hosts, served)
        await scenario.play()
        return scenario.report


def main() -> int:
    with TwoHosts(DELAY, 0.0, LOSS) as hosts, tempfile.TemporaryDirectory(prefix="mucat-") as name:
        report = asyncio.run(run(hosts, Path(name)))
    print(json.dumps(report.figures(), indent=2))  # noqa: T201 - it speaks to the test that started it
    return 0


if __name__ == "__main__":
    sys.exit(main())
