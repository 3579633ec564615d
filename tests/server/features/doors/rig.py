"""A server with open doors, and small clients of them."""

import asyncio
import json
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

from robot_runtime.config import DoorsConfig
from robot_runtime.contract import packets
from robot_runtime.contract.documents import Truth
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, row
from server.platform.settings import Settings
from tests.server.serving import Served, play
from tests.server.waiting import SECONDS

OPEN = DoorsConfig(rosbridge=True, foxglove=True)


def play_open(settings: Settings, scenario: Callable[[Served], Awaitable[None]]) -> None:
    """Run `scenario` with both doors open."""
    play(replace(settings, doors=OPEN), scenario)


async def make_token(served: Served, scope: str = "operate", name: str = "Program") -> str:
    """A new token of this scope."""
    said = {"name": name, "scope": scope}
    answer = await served.api.post("/access/tokens", json=said)
    answer.raise_for_status()
    return str(answer.json()["token"])


async def acts_of(served: Served) -> set[tuple[str, str, str]]:
    """The audit log's entries: who, what, with which outcome."""
    entries = (await served.api.get("/audit")).json()["entries"]
    return {(one["who"], one["action"], one["outcome"]) for one in entries}


def address(served: Served, door: str, token: str | None) -> str:
    """The address of a door, with a token."""
    query = f"?token={token}" if token else ""
    return f"ws://127.0.0.1:{served.settings.port}/{door}{query}"


class RosbridgeClient:
    """A program that speaks rosbridge over a socket of its own."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self._number = 0

    async def say(self, **operation: Any) -> None:
        """Send an operation."""
        await self.socket.send(json.dumps(operation))

    async def next(self, op: str, **fields: Any) -> dict[str, Any]:
        """The next message of this op with these fields; others are passed over."""
        async with asyncio.timeout(SECONDS):
            async for message in self.socket:
                found = json.loads(message)
                if found["op"] == op and all(found.get(key) == one for key, one in fields.items()):
                    assert isinstance(found, dict)
                    return found
        raise AssertionError(f"the socket was closed before {op} came")

    async def call(self, service: str, args: Any = None) -> dict[str, Any]:
        """Call a service; returns its whole answer."""
        self._number += 1
        number = f"call:{self._number}"
        await self.say(op="call_service", service=service, id=number, args={} if args is None else args)
        return await self.next("service_response", id=number)


def open_rosbridge(served: Served, token: str | None, **options: Any) -> connect:
    """A connection to the rosbridge door."""
    return connect(address(served, "rosbridge", token), max_size=None, compression=None, **options)


def rows_block(topic: str, first: int, *rows: tuple[float, Record]) -> Block:
    """A block of these rows: time (s, steady clock) and record."""
    data = b"".join(row(time, record.to_bytes()) for time, record in rows)
    return Block.of(BY_NAME[topic], len(rows), first, data)


def imu(attitude: tuple[float, float, float, float], **values: Any) -> packets.Imu:
    """A sample of the IMU, at rest but for these values."""
    given: dict[str, Any] = {"time": 0, "rate": (0.0, 0.0, 0.0), "force": (0.0, 0.0, -9.8)}
    return packets.Imu(attitude=attitude, **(given | values))


def truth(position: tuple[float, float, float], attitude: tuple[float, float, float, float]) -> Truth:
    """The body at rest at this place (north, east, down)."""
    still = (0.0, 0.0, 0.0)
    return Truth(position=position, attitude=attitude, velocity=still, rate=still, fins=(0.0, 0.0, 0.0, 0.0))
