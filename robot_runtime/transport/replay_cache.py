"""The blocks of the last minutes, for a server that was not running."""

import json
import threading
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from struct import Struct, error
from typing import Self

from robot_runtime.clock import Clock
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import HEADER, NUMBERS, Block, is_after, read_blocks

SECONDS = 300.0
"""As much as the page's charts show."""
BYTES_MAX = 4_000_000
"""Some minutes at the robot's full rate; a Raspberry Pi Zero has 512 MB for everything."""

_SIZE = Struct("<I")
_NOT_A_REPLY = (
    error,
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    ArithmeticError,
    RecursionError,
)


@dataclass(frozen=True, slots=True)
class BacklogReply:
    """The reply to a backlog request: the sender's run, its blocks, oldest first, and the next numbers.

    `next` are the numbers that the sender gives to the next sample of each topic (by name): samples between
    them and the last block that is here was never sent or is no longer kept.
    """

    run: str
    next: Mapping[str, int]
    blocks: list[Block]

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Read a reply. Raise LayoutError for invalid bytes."""
        try:
            (size,) = _SIZE.unpack_from(data)
            head = json.loads(data[_SIZE.size : _SIZE.size + size])
            numbers = {
                str(name): int(number) % NUMBERS for name, number in head["next"].items() if name in BY_NAME
            }
            run = str(head["run"])
            return cls(run, numbers, read_blocks(data[_SIZE.size + size :], run))
        except LayoutError:
            raise
        except _NOT_A_REPLY as problem:
            raise LayoutError(f"the backlog cannot be read: {problem!r}") from problem


class ReplayCache:
    """The last messages of blocks of the process that is called `run`, bounded in age and in bytes.

    Every method may be called from any thread.
    """

    def __init__(self, run: str, clock: Clock) -> None:
        self._run = run
        self._clock = clock
        self._lock = threading.Lock()
        self._messages: deque[tuple[float, bytes]] = deque()
        self._bytes = 0
        self._next: dict[str, int] = {}

    def add(self, message: bytes, following: Mapping[str, int]) -> None:
        """Add a message that is about to be sent; `following` are the topics' numbers after it."""
        now = self._clock.now()
        with self._lock:
            self._messages.append((now, message))
            self._bytes += len(message)
            while self._messages and (self._bytes > BYTES_MAX or self._messages[0][0] < now - SECONDS):
                self._bytes -= len(self._messages.popleft()[1])
            self._next.update(following)

    def answer(self, question: bytes) -> bytes:
        """Return the blocks from these numbers on; `question` is JSON, {topic: first number}.

        Topics that are not named are left out. Raise ValueError where it is no such object.
        """
        first_numbers = _read_question(question)
        with self._lock:
            messages = list(self._messages)
            following = {name: number % NUMBERS for name, number in self._next.items()}
        head = json.dumps({"run": self._run, "next": following}).encode()
        numbers = {BY_NAME[name].id: number for name, number in first_numbers.items()}
        return b"".join([_SIZE.pack(len(head)), head, *_cut(messages, numbers)])


def _cut(messages: Iterable[tuple[float, bytes]], numbers: Mapping[int, int]) -> Iterator[bytes]:
    """Yield the messages' blocks from these numbers on, by the topics' numbers.

    There are some ten thousand blocks, and a server that comes back waits for them: only heads are read.
    """
    for _, message in messages:
        at = 0
        while at < len(message):
            topic, _, count, first, size = HEADER.unpack_from(message, at)
            end = at + HEADER.size + size
            number = numbers.get(topic)
            if number is not None and is_after(first, count, number):
                yield message[at:end]
            at = end


def write_question(first_numbers: Mapping[str, int]) -> bytes:
    """Return the request for blocks from these numbers on, by the topics' names."""
    return json.dumps(dict(first_numbers)).encode()


def _read_question(question: bytes) -> dict[str, int]:
    first_numbers = json.loads(question)
    if not isinstance(first_numbers, dict):
        raise ValueError("a question for blocks must be a JSON object")
    for name, number in first_numbers.items():
        if name not in BY_NAME:
            raise ValueError(f"there is no topic {name!r}")
        if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < NUMBERS:
            raise ValueError(f"the number of {name} is {number!r}; it must be a whole number below 2^32")
    return first_numbers
