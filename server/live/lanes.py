"""What all sockets share: each message once, in memory, however many listen and however slow they are.

A lane is a bounded queue whose messages are numbered; every client has its own place in it. `History` keeps
the last minutes of each topic for a page that connects.
"""

from collections import deque
from dataclasses import dataclass

from robot_runtime.topics import BY_ID, Block, Topic

Totals = dict[int, int]
"""Samples of each topic, by its number, since the server started."""


@dataclass(frozen=True, slots=True)
class Message:
    """The same bytes for every client; `before` and `after` count the samples up to it and with it."""

    data: bytes
    before: Totals
    after: Totals


class Lane:
    """The newest messages; the oldest leave when they are too many or together too large."""

    def __init__(self, messages_max: int, bytes_max: int) -> None:
        self.first = 0
        self.totals: Totals = {}
        self._messages: deque[Message] = deque()
        self._messages_max = messages_max
        self._bytes_max = bytes_max
        self._bytes = 0

    @property
    def end(self) -> int:
        """The number that the next message will have."""
        return self.first + len(self._messages)

    def append(self, blocks: list[Block]) -> None:
        """Make one message of these blocks."""
        totals = dict(self.totals)
        for block in blocks:
            totals[block.topic.id] = totals.get(block.topic.id, 0) + block.count
        data = blocks[0].data if len(blocks) == 1 else b"".join(block.data for block in blocks)
        self._messages.append(Message(data, self.totals, totals))
        self.totals = totals
        self._bytes += len(data)
        while len(self._messages) > self._messages_max or (
            self._bytes > self._bytes_max and len(self._messages) > 1
        ):
            self._bytes -= len(self._messages.popleft().data)
            self.first += 1

    def get(self, number: int) -> Message:
        """The message of this number. Raises IndexError where it has left or is not there yet."""
        if not self.first <= number < self.end:
            raise IndexError(f"message {number} is not among {self.first} to {self.end - 1}")
        return self._messages[number - self.first]

    def lost(self, seen: Totals) -> list[tuple[Topic, int]]:
        """Samples after the totals `seen` that have left the lane."""
        before = self._messages[0].before if self._messages else self.totals
        counts = ((topic, total - seen.get(topic, 0)) for topic, total in before.items())
        return [(BY_ID[topic], count) for topic, count in counts if count > 0]


@dataclass(frozen=True, slots=True)
class _Kept:
    tick: int
    time: float
    data: bytes


class History:
    """The last `seconds` of every topic, each topic within `bytes_max`."""

    def __init__(self, seconds: float, bytes_max: int) -> None:
        self._seconds = seconds
        self._bytes_max = bytes_max
        self._topics: dict[int, deque[_Kept]] = {}
        self._bytes: dict[int, int] = {}

    def add(self, block: Block, tick: int, now: float) -> None:
        """Keep a block that goes out at `tick`, at `now` (s, steady clock)."""
        topic = block.topic.id
        kept = self._topics.setdefault(topic, deque())
        kept.append(_Kept(tick, now, block.data))
        size = self._bytes.get(topic, 0) + len(block.data)
        while kept and (kept[0].time < now - self._seconds or size > self._bytes_max):
            size -= len(kept.popleft().data)
        self._bytes[topic] = size

    def since(self, tick: int, message_bytes: int) -> list[list[bytes]]:
        """Every block that went out after `tick`, topic by topic, in groups of about `message_bytes`."""
        groups: list[list[bytes]] = []
        room = 0
        for kept in self._topics.values():
            for one in kept:
                if one.tick <= tick:
                    continue
                if len(one.data) > room:
                    groups.append([])
                    room = message_bytes
                groups[-1].append(one.data)
                room -= len(one.data)
        return groups
