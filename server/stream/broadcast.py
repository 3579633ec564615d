"""Buffers that all sockets share: each message is stored once, for any number of clients.

A buffer is a bounded queue of numbered messages; every client has its own position. `TopicHistory` holds the
last minutes of each topic for a page that connects.
"""

from collections import deque
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from math import inf

from robot_runtime.contract.topics import BY_ID, TIME, AnyTopic, Kind
from robot_runtime.transport.blocks import COUNT_MAX, HEADER, Block

CHUNK_SECONDS = 2.0
CHUNK_BLOCKS = 100

Totals = dict[int, int]
"""Samples of each topic, by its number, since the server started."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message as all clients get it; `before` and `after`: sample counts without it and with it."""

    data: bytes
    before: Totals
    after: Totals


class BroadcastBuffer:
    """Queue of the newest messages; the oldest are dropped when the number or the size is exceeded."""

    def __init__(self, messages_max: int, bytes_max: int) -> None:
        self.first = self.end = 0
        """Numbers of the oldest message and of the next one to come."""
        self.totals: Totals = {}
        self._messages: deque[Message] = deque()
        self._messages_max = messages_max
        self._bytes_max = bytes_max
        self._bytes = 0

    def append(self, blocks: list[Block]) -> None:
        """Append these blocks as one message."""
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
        """Return the message of this number. Raise IndexError where it was dropped or does not exist yet."""
        if not self.first <= number < self.end:
            raise IndexError(f"message {number} is not among {self.first} to {self.end - 1}")
        return self._messages[number - self.first]

    def lost(self, seen: Totals) -> list[tuple[AnyTopic, int]]:
        """Return the numbers of dropped samples after the totals `seen`, by topic."""
        before = self._messages[0].before if self._messages else self.totals
        counts = ((topic, total - seen.get(topic, 0)) for topic, total in before.items())
        return [(BY_ID[topic], count) for topic, count in counts if count > 0]


@dataclass(frozen=True, slots=True)
class _Chunk:
    """Consecutive blocks that were sent up to `tick`; rows begin at the time `since`."""

    tick: int
    since: float
    data: bytes


class _TopicBacklog:
    """Backlog of one topic: the newest blocks as they came, older ones merged into chunks."""

    def __init__(self, topic: AnyTopic) -> None:
        self.topic = topic
        self.bytes = 0
        self._chunks: deque[_Chunk] = deque()
        self._blocks: list[Block] = []
        self._since = 0.0
        self._tick = 0

    def add(self, block: Block, tick: int, time: float) -> bool:
        """Add a block; return True where it completed a chunk."""
        if not self._blocks:
            self._since = time
        self._blocks.append(block)
        self._tick = tick
        self.bytes += len(block.data)
        complete = time - self._since >= CHUNK_SECONDS or len(self._blocks) >= CHUNK_BLOCKS
        if complete:
            self._gather()
        return complete

    def forget(self, before: float, bytes_max: int) -> None:
        while self._chunks and (self._chunks[0].since < before or self.bytes > bytes_max):
            self.bytes -= len(self._chunks.popleft().data)

    def forget_all(self) -> None:
        self._blocks.clear()
        self._chunks.clear()
        self.bytes = 0

    def chunks(self) -> Iterable[_Chunk]:
        # Blocks that are returned now must not share a chunk with later ones.
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
    """The last `seconds` of every topic, at most `bytes_max` each; of some topics only the newest block.

    A Python object per small block doubles its memory: blocks of two seconds are merged into one chunk, which
    is also faster to send.
    """

    def __init__(self, seconds: float, bytes_max: int) -> None:
        self._seconds = seconds
        self._bytes_max = bytes_max
        self._topics: dict[int, _TopicBacklog] = {}

    def add(self, block: Block, tick: int, now: float) -> None:
        """Add a block that is sent at `tick`, at `now` (s, steady clock)."""
        topic = block.topic
        backlog = self._topics.get(topic.id)
        if backlog is None:
            backlog = self._topics[topic.id] = _TopicBacklog(topic)
        if topic.newest_only:
            backlog.forget_all()
        # A backlog from before this server's start is older than now.
        time = TIME.unpack_from(block.data, HEADER.size)[0] if topic.kind is Kind.ROWS else now
        if backlog.add(block, tick, time):
            backlog.forget(now - self._seconds, self._bytes_max)

    def since(self, tick: int, message_bytes: int, rows_from: float = -inf) -> list[list[bytes]]:
        """Return every block sent after `tick`, topic by topic, in groups of about `message_bytes`.

        Rows before `rows_from` (s, steady clock) are left out, but for up to `CHUNK_SECONDS`.
        """
        groups: list[list[bytes]] = []
        room = 0
        for backlog in self._topics.values():
            first = rows_from - CHUNK_SECONDS if backlog.topic.kind is Kind.ROWS else -inf
            for chunk in backlog.chunks():
                if chunk.tick <= tick or chunk.since < first:
                    continue
                if len(chunk.data) > room:
                    groups.append([])
                    room = message_bytes
                groups[-1].append(chunk.data)
                room -= len(chunk.data)
        return groups

    def rows(self, topics: Collection[str], until: float) -> list[bytes]:
        """Return the stored rows of these topics until `until` (s, steady clock), up to `CHUNK_SECONDS` more.

        They are the stored chunks themselves, in memory only once for all callers.
        """
        return [
            chunk.data
            for backlog in self._topics.values()
            if backlog.topic.name in topics
            for chunk in backlog.chunks()
            if chunk.since < until
        ]


def _join(blocks: Sequence[Block]) -> bytes:
    """Join blocks of one topic; consecutive rows become one block with one header."""
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
