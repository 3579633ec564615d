"""Samples of a running robot as they come, by its live socket."""

import json
from collections.abc import AsyncIterator, Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from websockets.asyncio.client import connect as connect_async
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.sync.client import ClientConnection, connect

from mucat.address import RobotAddress
from mucat.errors import RobotError
from robot_runtime.contract.packets import DEFINITIONS_HASH
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import BY_NAME, TIME, Kind
from robot_runtime.transport.blocks import read_blocks, read_rows


@dataclass(frozen=True, slots=True)
class LiveSample:
    """A sample: its topic, its time (s, the robot's steady clock), and its fields in SI units.

    A picture has one field, `jpeg`. `docs/reference/topics.md` lists topics and fields.
    """

    topic: str
    time: float
    fields: Mapping[str, Any]

    def __getitem__(self, name: str) -> Any:
        """Return a field's value."""
        return self.fields[name]


class LiveReader:
    """Reader of the samples of some topics in the socket's messages; `after` leaves out older ones."""

    def __init__(self, topics: tuple[str, ...]) -> None:
        unknown = [name for name in topics if name not in BY_NAME]
        if unknown or not topics:
            raise RobotError(
                f"There is no topic {', '.join(unknown) or 'named'}; there are {', '.join(BY_NAME)}."
            )
        self._topics = frozenset(topics)
        self._after = float("-inf")

    @property
    def pictures(self) -> list[str]:
        """The reader's topics of pictures."""
        return sorted(name for name in self._topics if BY_NAME[name].kind is Kind.PICTURE)

    def greet(self, message: str | bytes) -> dict[str, Any]:
        """Read the server's first message. Raise RobotError where its definitions differ."""
        hello: dict[str, Any] = json.loads(message)
        if hello["definitions"] != f"{DEFINITIONS_HASH:08x}":
            raise RobotError("The robot runs another version of µ-CAT. Install the same version here.")
        self._after = hello["steady"]
        return hello

    def read(self, message: str | bytes) -> list[LiveSample]:
        """Return the samples of these topics in a message."""
        if isinstance(message, str):
            return []
        samples: list[LiveSample] = []
        for block in read_blocks(message):
            name = block.topic.name
            if name not in self._topics:
                continue
            if block.topic.kind is Kind.ROWS:
                samples += [LiveSample(name, time, _values(record)) for time, record in read_rows(block)]
            elif block.topic.kind is Kind.DOCUMENTS:
                samples += [
                    LiveSample(name, document["time"], document) for document in json.loads(block.payload)
                ]
            else:
                time = TIME.unpack_from(block.payload)[0]
                samples.append(LiveSample(name, time, {"jpeg": block.payload[TIME.size :]}))
        return [
            sample for sample in samples if sample.time >= self._after or BY_NAME[sample.topic].newest_only
        ]


@contextmanager
def open_live(address: RobotAddress) -> Iterator[ClientConnection]:
    """Yield an open live socket. Raise RobotError."""
    try:
        with connect(
            address.live, additional_headers=address.headers, compression=None, max_size=None
        ) as socket:
            yield socket
    except (OSError, InvalidHandshake) as problem:
        raise RobotError(f"{address.url} does not let this program in: {problem}.") from problem
    except ConnectionClosed as problem:
        raise RobotError(_ended(problem)) from problem


def read_live(address: RobotAddress, topics: tuple[str, ...]) -> Generator[LiveSample, None, None]:
    """Yield samples from now on, until the caller breaks off. Raise RobotError where the connection ends."""
    reader = LiveReader(topics)
    with open_live(address) as socket:
        reader.greet(socket.recv())
        socket.send(json.dumps({"op": "watch", "pictures": reader.pictures}))
        for message in socket:
            yield from reader.read(message)


async def read_live_async(address: RobotAddress, topics: tuple[str, ...]) -> AsyncIterator[LiveSample]:
    """Yield samples as `read_live`, for asyncio."""
    reader = LiveReader(topics)
    try:
        async with connect_async(
            address.live, additional_headers=address.headers, compression=None, max_size=None
        ) as socket:
            reader.greet(await socket.recv())
            await socket.send(json.dumps({"op": "watch", "pictures": reader.pictures}))
            async for message in socket:
                for sample in reader.read(message):
                    yield sample
    except (OSError, InvalidHandshake) as problem:
        raise RobotError(f"{address.url} does not let this program in: {problem}.") from problem
    except ConnectionClosed as problem:
        raise RobotError(_ended(problem)) from problem


def _values(record: Record) -> dict[str, Any]:
    return {name: getattr(record, name) for name in record.wires}


def _ended(problem: ConnectionClosed) -> str:
    reason = problem.rcvd.reason if problem.rcvd is not None else ""
    return f"The robot ended the connection: {reason or 'it said no reason.'}"
