"""A server with open doors, and small clients of them."""

import asyncio
import json
import time
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect

from robot_runtime.contract import packets
from robot_runtime.contract.documents import Truth
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, row
from server.features.doors import subscriptions
from server.features.doors.config import DoorsConfig
from server.features.doors.subscriptions import DoorClient
from server.http.sign_in.access import Access
from server.stream import socket_ends
from tests.server.serving import Served
from tests.server.waiting import SECONDS, SOCKET_LIMITS

OPEN = DoorsConfig(rosbridge=True, foxglove=True)
LIFE = 3600.0
"""s; a token's whole time, see `TokenTime`."""


async def make_token(served: Served, scope: str = "operate", name: str = "Program") -> str:
    """Return a new token of this scope."""
    output = {"name": name, "scope": scope}
    answer = await served.api.post("/access/tokens", json=output)
    answer.raise_for_status()
    return str(answer.json()["token"])


class TokenTime:
    """The time of one program's token: it goes on when the test says so, however slow the computer is."""

    def __init__(self, served: Served, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
        self._date = time.time()
        self._waiting: list[asyncio.Timeout] = []
        devices = served.get(Access).devices
        (self._device,) = (device for device in devices.all() if device.name == name)
        self._ends = self._device.ends = self._date + LIFE
        monkeypatch.setattr(devices, "_utc", lambda: self._date)
        monkeypatch.setattr(socket_ends, "asyncio", SimpleNamespace(timeout=self._limit))

    def end(self) -> None:
        """The token's time passes now, also for who waits for its end."""
        self._date += LIFE
        assert self._waiting
        for limit in self._waiting:
            with suppress(RuntimeError):  # that connection is over
                limit.reschedule(asyncio.get_running_loop().time())

    def _limit(self, seconds: float | None) -> asyncio.Timeout:
        limit = asyncio.timeout(seconds)
        if seconds == self._ends - self._date:
            self._waiting.append(limit)
        return limit


def hurry(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Disconnect a program of this name that reads nothing for a second.

    Others have their time: the process in which they read is the server's own, and may be held for as long.
    """
    monkeypatch.setattr(subscriptions, "STALL_SECONDS", SECONDS)
    send = DoorClient._send

    async def send_to(client: DoorClient, message: bytes | str) -> None:
        # It is read before anything is awaited.
        vars(subscriptions)["STALL_SECONDS"] = 1.0 if client.identity.name == name else SECONDS
        await send(client, message)

    monkeypatch.setattr(DoorClient, "_send", send_to)


async def acts_of(served: Served) -> set[tuple[str, str, str]]:
    """Return the audit log's entries: who, what, with which outcome."""
    entries = (await served.api.get("/audit")).json()["entries"]
    return {(entry["who"], entry["action"], entry["outcome"]) for entry in entries}


def address(served: Served, door: str, token: str | None) -> str:
    """Return the address of a door, with a token."""
    query = f"?token={token}" if token else ""
    return f"ws://127.0.0.1:{served.settings.server.port}/{door}{query}"


class RosbridgeClient:
    """A program that speaks rosbridge over a socket of its own."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self._number = 0

    async def say(self, **operation: Any) -> None:
        """Send an operation."""
        await self.socket.send(json.dumps(operation))

    async def next(self, op: str, **fields: Any) -> dict[str, Any]:
        """Return the next message of this op with these fields; others are passed over."""
        async with asyncio.timeout(SECONDS):
            async for message in self.socket:
                answer = json.loads(message)
                if answer["op"] == op and all(answer.get(key) == value for key, value in fields.items()):
                    assert isinstance(answer, dict)
                    return answer
        raise AssertionError(f"the socket was closed before {op} came")

    async def call(self, service: str, args: Any = None) -> dict[str, Any]:
        """Call a service; return its whole answer."""
        self._number += 1
        number = f"call:{self._number}"
        await self.say(op="call_service", service=service, id=number, args={} if args is None else args)
        return await self.next("service_response", id=number)


def open_rosbridge(served: Served, token: str | None, **options: Any) -> connect:
    """Return a connection to the rosbridge door."""
    return connect(
        address(served, "rosbridge", token), max_size=None, compression=None, **(SOCKET_LIMITS | options)
    )


def rows_block(topic: str, first: int, *rows: tuple[float, Record]) -> Block:
    """Return a block of these rows: time (s, steady clock) and record."""
    data = b"".join(row(time, record.to_bytes()) for time, record in rows)
    return Block.of(BY_NAME[topic], len(rows), first, data)


def imu(attitude: tuple[float, float, float, float], **values: Any) -> packets.Imu:
    """Return a sample of the IMU, at rest but for these values."""
    given: dict[str, Any] = {"time": 0, "rate": (0.0, 0.0, 0.0), "force": (0.0, 0.0, -9.8)}
    return packets.Imu(attitude=attitude, **(given | values))


def truth(position: tuple[float, float, float], attitude: tuple[float, float, float, float]) -> Truth:
    """Return the body at rest at this place (north, east, down)."""
    still = (0.0, 0.0, 0.0)
    return Truth(position=position, attitude=attitude, velocity=still, rate=still, fins=(0.0, 0.0, 0.0, 0.0))
