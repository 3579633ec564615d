"""Frames of the serial line, without I/O.

    frame := COBS( control u8 | messages | number u8, unreliable frames alone | CRC-32 u32 ) 00
    messages := { type u8 | payload }        the type implies the payload's length

COBS (Cheshire and Baker, 1999) leaves zero as the one byte that never occurs inside a frame, so that after
any damage the next zero is a clean start.

The first message says whether a frame is reliable: all of a kind travel together. The lower half of
`control` is the number of the reliable frame that its sender waits for. The upper half is a reliable frame's
own number; of an unreliable frame's number, which has twelve bits, it is the upper four, and the last byte
has the rest.

The CRC is IEEE 802.3's (zlib.crc32) over everything before it, combined by exclusive or with a key that both
ends derive from their epochs. A frame of another session is thus no frame at all. HELLO and STOP travel in
open frames, whose key is 0: they must be understood by whoever hears them.
"""

import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from struct import Struct

from cobs import cobs

from robot_runtime.packets import FRAME_BYTES_MAX, PACKETS, Packet, encode
from robot_runtime.packets.layout import LayoutError

OPEN = 0
"""The key of frames that belong to no session."""
RELIABLE_NUMBERS = 16
UNRELIABLE_NUMBERS = 4096
_CRC = Struct("<I")
# One byte of COBS for every 254, and the closing zero.
CONTENT_BYTES_MAX = FRAME_BYTES_MAX - 2
MESSAGES_BYTES_MAX = CONTENT_BYTES_MAX - 1 - _CRC.size
"""In a reliable frame; an unreliable one has room for one byte less."""

Messages = tuple[tuple[int, bytes], ...]
Seen = Callable[[bytes], None]


@dataclass(frozen=True, slots=True)
class Frame:
    """One valid frame. `open` tells one that belongs to no session; messages are type and payload."""

    number: int
    acknowledged: int
    reliable: bool
    open: bool
    messages: Messages


def build(packets: Iterable[Packet], number: int, acknowledged: int, key: int = OPEN) -> bytes:
    """The bytes of a frame. Raises LayoutError where the packets do not fit one."""
    some = list(packets)
    messages = b"".join(map(encode, some))
    return assemble(messages, any(one.reliable for one in some), number, acknowledged, key)


def assemble(messages: bytes, reliable: bool, number: int, acknowledged: int, key: int) -> bytes:
    """The same, of packets that are bytes already."""
    room = MESSAGES_BYTES_MAX if reliable else MESSAGES_BYTES_MAX - 1
    if len(messages) > room:
        raise LayoutError(f"{len(messages)} bytes of packets do not fit a frame, which takes {room}")
    upper = number if reliable else number >> 8
    content = bytes([(upper & 15) << 4 | acknowledged & 15]) + messages
    if not reliable:
        content += bytes([number & 255])
    stuffed: bytes = cobs.encode(content + _CRC.pack(zlib.crc32(content) ^ key))
    return stuffed + b"\0"


class Decoder:
    """Cuts a stream of bytes into frames; what is not a valid frame is dropped and counted.

    `key` is that of the session; `seen` is shown every frame's bytes, valid or not.
    """

    def __init__(self, packets: Mapping[int, type[Packet]] = PACKETS, seen: Seen | None = None) -> None:
        self.invalid = 0
        self.key = OPEN
        self._packets = packets
        self._seen = seen
        self._pending = bytearray()
        self._overlong = False

    def feed(self, data: bytes) -> Iterator[Frame]:
        """The frames that these bytes complete, in order."""
        *ends, rest = data.split(b"\0")
        for part in ends:
            self._take(part)
            frame = self._close()
            if frame is not None:
                yield frame
        self._take(rest)

    def _take(self, part: bytes) -> None:
        self._pending += part
        if len(self._pending) >= FRAME_BYTES_MAX:
            # No frame is this long: forget it now, so that garbage never fills the memory.
            self._overlong = True
            self._pending.clear()

    def _close(self) -> Frame | None:
        content, self._pending = bytes(self._pending), bytearray()
        overlong, self._overlong = self._overlong, False
        if not content and not overlong:
            return None  # two zeros in a row: an idle line, nothing lost
        if self._seen is not None:
            self._seen(content)
        frame = None if overlong else self._parse(content)
        if frame is None:
            self.invalid += 1
        return frame

    def _parse(self, stuffed: bytes) -> Frame | None:
        """The frame between two zeros; None where it is damaged in any way."""
        try:
            content = cobs.decode(stuffed)
        except cobs.DecodeError:
            return None
        if len(content) < 2 + _CRC.size:
            return None
        body = content[: -_CRC.size]
        key = _CRC.unpack_from(content, len(body))[0] ^ zlib.crc32(body)
        first = self._packets.get(body[1])
        if key not in (OPEN, self.key) or first is None:
            return None
        end = len(body) if first.reliable else len(body) - 1
        messages = self._split(body, end)
        if messages is None:
            return None
        number = body[0] >> 4 if first.reliable else (body[0] >> 4) << 8 | body[-1]
        return Frame(number, body[0] & 15, first.reliable, key == OPEN, messages)

    def _split(self, body: bytes, end: int) -> Messages | None:
        messages: list[tuple[int, bytes]] = []
        at = 1
        while at < end:
            cls = self._packets.get(body[at])
            if cls is None:
                return None
            start, size = at + 1, cls.layout.size
            if cls.tail:
                if start + size >= end or body[start + size] > cls.tail[1].max_bytes:
                    return None
                size += 1 + body[start + size]
            at = start + size
            if at > end:
                return None
            messages.append((body[start - 1], body[start:at]))
        return tuple(messages) or None
