"""Buffers that all sockets share: each message is stored once, for any number of clients.

A buffer is a bounded queue of numbered messages; every client has its own position. `TopicHistory` holds the
last minutes of each topic for a page that connects.
"""

from collections import deque
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from math import inf

from robot_runtime.contract.topics import BY_ID, Kind, Topic
from robot_runtime.transport.blocks import Block

CHUNK_SECONDS = 2.0
CHUNK_BLOCKS = 100
COUNT_MAX = 65_535
"""Samples in one block."""

Totals = dict[int, int]
"""Samples of each topic, by its number, since the server started."""


@dataclass(frozen=True, slots=True)
class Message:
    """The same bytes for every client; `before` and `after` count the samples up to it and with it."""

    data: bytes
    before: Totals
    after: Totals


class BroadcastBuffer:
    """The newest messages; the oldest are dropped when they are too many or together too large."""

    def __init__(self, messages_max: int, bytes_max: int) -> None:
        self.first = self.end = 0
        """The number of the oldest message, and that which the next one will have."""
        self.totals: Totals = {}
        self._messages: deque[Message] = deque()
        self._messages_max = messages_max
        self._bytes_max = bytes_max
        self._bytes = 0

    def append(self, blocks: list[Block]) -> None:
        """Make one message of these blocks."""
        totals = dict(self.totals)
        for block in blocks:
            totals[block.topic.id] = totals.get(block.topic.id, 0) + block.count
        data = blocks[0].data if len(blocks) == 1 else b"".join(block.data for block in blocks)
        self._messages.append(Message(data, self.totals, totals))
        self.end += 1
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
        """Samples after the totals `seen` that have left the buffer."""
        before = self._messages[0].before if self._messages else self.totals
        counts = ((topic, total - seen.get(topic, 0)) for topic, total in before.items())
        return [(BY_ID[topic], count) for topic, count in counts if count > 0]


@dataclass(frozen=True, slots=True)
class _Chunk:
    """Blocks one after the other that went out up to `tick`; rows begin at the time `since`."""

    tick: int
    since: float
    data: bytes


class _TopicBacklog:
    """Backlog of one topic: the newest blocks as they came, older ones merged into chunks."""

    def __init__(self, topic: Topic) -> None:
        self.topic = topic
        self.bytes = 0
        self._chunks: deque[_Chunk] = deque()
        self._blocks: list[Block] = []
        self._since = 0.0
        self._tick = 0

    def add(self, block: Block, tick: int, time: float) -> None:
        if not self._blocks:
            self._since = time
        self._blocks.append(block)
        self._tick = tick
        self.bytes += len(block.data)
        if time - self._since >= CHUNK_SECONDS or len(self._blocks) >= CHUNK_BLOCKS:
            self._gather()

    def forget(self, before: float, bytes_max: int) -> None:
        while self._chunks and (self._chunks[0].since < before or self.bytes > bytes_max):
            self.bytes -= len(self._chunks.popleft().data)

    def forget_all(self) -> None:
        self._blocks.clear()
        self._chunks.clear()
        self.bytes = 0

    def chunks(self) -> Iterable[_Chunk]:
        # What is given now must not be part of a chunk with what comes later.
        self._gather()
        return self._chunks

    def _gather(self) -> None:
        if not self._blocks:
            return
        data = _join(self._blocks)
        self.bytes += len(data) - sum(len(block.data) for block in self._blocks)
        self._chunks.append(_Chunk(self._tick, self._since, data))
        self._blocks.clear()


class TopicHistory:
    """The last `seconds` of every topic, each within `bytes_max`; of some topics the newest block only.

    A block is small, and Python's own bytes around it are as many again. So those of two seconds become one,
    which is soon sent, too.
    """

    def __init__(self, seconds: float, bytes_max: int) -> None:
        self._seconds = seconds
        self._bytes_max = bytes_max
        self._topics: dict[int, _TopicBacklog] = {}

    def add(self, block: Block, tick: int, now: float) -> None:
        """Keep a block that goes out at `tick`, at `now` (s, steady clock)."""
        backlog = self._topics.setdefault(block.topic.id, _TopicBacklog(block.topic))
        if block.topic.newest_only:
            backlog.forget_all()
        # What a server takes over from an earlier one is older than now.
        backlog.add(block, tick, block.time_of(block.first) if block.topic.kind is Kind.ROWS else now)
        backlog.forget(now - self._seconds, self._bytes_max)

    def since(self, tick: int, message_bytes: int, rows_from: float = -inf) -> list[list[bytes]]:
        """Every block that went out after `tick`, topic by topic, in groups of about `message_bytes`.

        Of rows only what is not before `rows_from` (s, steady clock), or a little more.
        """
        groups: list[list[bytes]] = []
        room = 0
        for backlog in self._topics.values():
            first = rows_from - CHUNK_SECONDS if backlog.topic.kind is Kind.ROWS else -inf
            for one in backlog.chunks():
                if one.tick <= tick or one.since < first:
                    continue
                if len(one.data) > room:
                    groups.append([])
                    room = message_bytes
                groups[-1].append(one.data)
                room -= len(one.data)
        return groups

    def rows(self, topics: Collection[str], until: float) -> bytes:
        """The rows of these topics that are kept, up to `until` (s, steady clock) or a little more."""
        return b"".join(
            one.data
            for backlog in self._topics.values()
            if backlog.topic.name in topics
            for one in backlog.chunks()
            if one.since < until
        )


def _join(blocks: Sequence[Block]) -> bytes:
    """These blocks of one topic; rows that follow each other as one block, which saves their heads."""
    runs: list[list[Block]] = []
    count = 0
    for block in blocks:
        follows = runs and runs[-1][-1].following == block.first and count + block.count <= COUNT_MAX
        if block.topic.kind is Kind.ROWS and follows:
            runs[-1].append(block)
            count += block.count
        else:
            runs.append([block])
            count = block.count
    return b"".join(map(_merge, runs))


def _merge(run: Sequence[Block]) -> bytes:
    first = run[0]
    if len(run) == 1:
        return first.data
    payload = b"".join(block.payload for block in run)
    return Block.of(first.topic, sum(block.count for block in run), first.first, payload).data
