"""Samples of a running robot as they come, by its live socket."""

import asyncio
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
from mucat.pictures import decode_picture
from mucat.topics import RobotTopics, TopicDescription, ask_topics
from robot_runtime.contract.topics import TIME
from robot_runtime.transport.blocks import HEADER


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

    def picture(self) -> Any:
        """Return its picture as an array, height × width × 3: red, green, blue. Raise RobotError."""
        return decode_picture(self.fields["jpeg"])


class LiveReader:
    """Reader of the samples of some topics in the socket's messages; older ones are left out.

    Topics of which it knows nothing are passed over.
    """

    def __init__(self, names: tuple[str, ...], topics: RobotTopics) -> None:
        unknown = [name for name in names if name not in topics.by_name]
        if unknown or not names:
            raise RobotError(
                f"There is no topic {', '.join(unknown) or 'named'}; there are {', '.join(topics.by_name)}."
            )
        self._names = frozenset(names)
        self._topics = topics
        self._by_number = {topics.by_name[name].number: topics.by_name[name] for name in names}
        self._after = float("-inf")

    @property
    def pictures(self) -> list[str]:
        """The reader's topics of pictures."""
        return sorted(topic.name for topic in self._by_number.values() if topic.kind == "picture")

    def greet(self, message: str | bytes) -> None:
        """Read the server's first message. Raise RobotError where its samples cannot be read."""
        hello: dict[str, Any] = json.loads(message)
        self._topics.check(hello["definitions"], self._names)
        self._after = hello["steady"]

    def read(self, message: str | bytes) -> list[LiveSample]:
        """Return the samples of these topics in a message."""
        samples: list[LiveSample] = []
        if isinstance(message, bytes):
            at = 0
            while at < len(message):
                number, _, _, _, size = HEADER.unpack_from(message, at)
                start, at = at + HEADER.size, at + HEADER.size + size
                if (topic := self._by_number.get(number)) is not None:
                    samples += self._read_block(topic, message[start:at])
        return samples

    def _read_block(self, topic: TopicDescription, payload: bytes) -> list[LiveSample]:
        if topic.kind == "rows":
            read = [LiveSample(topic.name, time, fields) for time, fields in topic.read_rows(payload)]
        elif topic.kind == "documents":
            read = [LiveSample(topic.name, document["time"], document) for document in json.loads(payload)]
        else:
            time = TIME.unpack_from(payload)[0]
            read = [LiveSample(topic.name, time, {"jpeg": payload[TIME.size :]})]
        return [sample for sample in read if topic.newest_only or sample.time >= self._after]


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
    reader = LiveReader(topics, ask_topics(address))
    with open_live(address) as socket:
        reader.greet(socket.recv())
        socket.send(json.dumps({"op": "watch", "pictures": reader.pictures}))
        for message in socket:
            yield from reader.read(message)


async def read_live_async(address: RobotAddress, topics: tuple[str, ...]) -> AsyncIterator[LiveSample]:
    """Yield samples as `read_live`, for asyncio."""
    reader = LiveReader(topics, await asyncio.to_thread(ask_topics, address))
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


def _ended(problem: ConnectionClosed) -> str:
    reason = problem.rcvd.reason if problem.rcvd is not None else ""
    return f"The robot ended the connection: {reason or 'it said no reason.'}"
