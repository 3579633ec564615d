"""The framings of the test, and the host's ends of those that know nothing of sessions, without any I/O.

`plain` (the thesis's Table 5): a number is two bytes, the high one first; the request is the byte 0xff, so
that numbers may be 0 to 254. `thesis` (Figure 9, Table 4): `~ T D0 D1 CS0 CS1 CS2 CS3 \\n`, the checksum is
the XOR of T and the data as a number of four bytes; the end mark alone ends a packet. The chip answers a
request in both with a thesis packet of type REQUEST_RESULT whose data are hexadecimal digits.

`robot` is the robot's own link; `link_end` is its host's end.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import reduce
from operator import xor
from typing import Literal

from robot_runtime.experiments.comm_test.results import Counts

PACKET_START = 0x7E
PACKET_END = 0x0A
TEST_MSG = 0x01
REQUEST_RESULT = 0x02
CHECKSUM_BYTES = 4
COUNT_DIGITS = 4
NUMBER_MAX = 32767
ANSWER_BYTES = 2 + COUNT_DIGITS * len(fields(Counts)) + CHECKSUM_BYTES + 1
PLAIN_REQUEST = b"\xff"
MESSAGE_CONTENT = 1 + 2 + CHECKSUM_BYTES


class Sequence:
    """Judge of arriving numbers: right is a number of the test that is above all earlier right numbers."""

    def __init__(self, start: int, end: int) -> None:
        self._next = start
        self._end = end
        self.right = 0
        self.out_of_sequence = 0

    def take(self, number: int) -> None:
        """Count an arrived number."""
        if self._next <= number < self._end:
            self.right += 1
            self._next = number + 1
        else:
            self.out_of_sequence += 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Framing:
    """A framing of the sketch: `code` is its macro; `library`: it needs the robot's own library.

    `number_max` is the largest number that can be sent, `bauds` are the lowest and the highest that it runs
    at, in bit/s.
    """

    code: str
    number_max: int
    bauds: tuple[int, int] = (1, 16_000_000)
    library: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamFraming(Framing):
    """A framing of numbers: `message` writes one, `request` asks for the result, `count` reads them."""

    request: bytes
    message: Callable[[int], bytes]
    count: Callable[[bytes, int, int], Counts]


def make_packet(kind: int, data: bytes = b"") -> bytes:
    """Return a packet of Figure 9."""
    content = bytes([kind]) + data
    return bytes([PACKET_START]) + content + _checksum(content) + bytes([PACKET_END])


def find_answer(stream: bytes) -> tuple[Counts, int] | None:
    """Return the chip's first answer in these bytes, and its position; None where there is none."""
    mark = bytes([PACKET_START, REQUEST_RESULT])
    at = stream.find(mark)
    while at >= 0:
        counts = _read_answer(stream[at : at + ANSWER_BYTES])
        if counts:
            return counts, at
        at = stream.find(mark, at + 1)
    return None


def _read_answer(packet: bytes) -> Counts | None:
    digits = packet[2 : -CHECKSUM_BYTES - 1]
    if len(packet) != ANSWER_BYTES or packet != make_packet(REQUEST_RESULT, digits):
        return None
    try:
        values = [int(digits[i : i + COUNT_DIGITS], 16) for i in range(0, len(digits), COUNT_DIGITS)]
    except ValueError:
        return None
    return Counts(*values)


def _checksum(content: bytes) -> bytes:
    return reduce(xor, content, 0).to_bytes(CHECKSUM_BYTES, "big")


def _plain_message(number: int) -> bytes:
    return number.to_bytes(2, "big")


def _count_plain(stream: bytes, start: int, end: int) -> Counts:
    sequence = Sequence(start, end)
    for at in range(0, len(stream) - 1, 2):
        sequence.take(int.from_bytes(stream[at : at + 2], "big"))
    return Counts(sequence.right, sequence.out_of_sequence, 0, len(stream) % 2, 0, len(stream))


def _thesis_message(number: int) -> bytes:
    return make_packet(TEST_MSG, number.to_bytes(2, "big"))


def _count_thesis(stream: bytes, start: int, end: int) -> Counts:
    sequence = Sequence(start, end)
    framing_errors = checksum_errors = 0
    at = stream.find(PACKET_START)
    while at >= 0:
        stop = stream.find(PACKET_END, at)
        if stop < 0:
            framing_errors += 1
            break
        content, checksum = stream[at + 1 : stop - CHECKSUM_BYTES], stream[stop - CHECKSUM_BYTES : stop]
        if stop - at - 1 != MESSAGE_CONTENT or content[0] != TEST_MSG:
            framing_errors += 1
        elif checksum != _checksum(content):
            checksum_errors += 1
        else:
            sequence.take(int.from_bytes(content[1:], "big"))
        at = stream.find(PACKET_START, stop)
    return Counts(sequence.right, sequence.out_of_sequence, checksum_errors, framing_errors, 0, len(stream))


FramingName = Literal["plain", "thesis", "robot"]
STREAM_FRAMINGS: Mapping[FramingName, StreamFraming] = {
    "plain": StreamFraming(
        code="COMM_TEST_PLAIN",
        number_max=254,
        request=PLAIN_REQUEST,
        message=_plain_message,
        count=_count_plain,
    ),
    "thesis": StreamFraming(
        code="COMM_TEST_THESIS",
        number_max=NUMBER_MAX,
        request=make_packet(REQUEST_RESULT),
        message=_thesis_message,
        count=_count_thesis,
    ),
}
ROBOT = Framing(code="COMM_TEST_ROBOT", number_max=NUMBER_MAX, bauds=(1200, 500_000), library=True)
FRAMINGS: Mapping[FramingName, Framing] = {**STREAM_FRAMINGS, "robot": ROBOT}
