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

from collections.abc import Callable, Iterable, Iterator, Mapping
from struct import Struct
from typing import NamedTuple
from zlib import crc32

from cobs.cobs import DecodeError
from cobs.cobs import decode as unstuff
from cobs.cobs import encode as stuff

from robot_runtime.contract.packets import FRAME_BYTES_MAX, PACKETS, Packet, encode
from robot_runtime.contract.packets.layout import LayoutError

OPEN = 0
"""The key of frames that belong to no session."""
RELIABLE_NUMBERS = 16
UNRELIABLE_NUMBERS = 4096
_CRC = Struct("<I")
# One byte of COBS for every 254, and the closing zero.
CONTENT_BYTES_MAX = FRAME_BYTES_MAX - 2
MESSAGES_BYTES_MAX = CONTENT_BYTES_MAX - 1 - _CRC.size
"""Largest size of the messages in a reliable frame; an unreliable one has room for one byte less."""
_CONTENT_BYTES_MIN = 2 + _CRC.size
_BYTES = [bytes([value]) for value in range(256)]

Messages = tuple[tuple[int, bytes], ...]
Seen = Callable[[bytes], None]


class Frame(NamedTuple):
    """One valid frame. `open` tells one that belongs to no session; messages are type and payload."""

    number: int
    acknowledged: int
    reliable: bool
    open: bool
    messages: Messages


def build(packets: Iterable[Packet], number: int, acknowledged: int, key: int = OPEN) -> bytes:
    """Return the bytes of a frame. Raise LayoutError where the packets do not fit one."""
    some = list(packets)
    messages = b"".join(map(encode, some))
    return assemble(messages, any(packet.reliable for packet in some), number, acknowledged, key)


def assemble(messages: bytes, reliable: bool, number: int, acknowledged: int, key: int) -> bytes:
    """Return the bytes of a frame of packets that are bytes already."""
    room = MESSAGES_BYTES_MAX if reliable else MESSAGES_BYTES_MAX - 1
    if len(messages) > room:
        raise LayoutError(f"{len(messages)} bytes of packets do not fit a frame, which takes {room}")
    if reliable:
        content = _BYTES[(number & 15) << 4 | acknowledged & 15] + messages
    else:
        control = number >> 4 & 0xF0 | acknowledged & 15
        content = _BYTES[control] + messages + _BYTES[number & 255]
    stuffed: bytes = stuff(content + _CRC.pack(crc32(content) ^ key))
    return stuffed + b"\0"


def _residue(key: int) -> int:
    """Return the CRC of anything that is followed by its own CRC, combined with this key.

    A CRC is linear, so that what stands before has no part in it: this takes the CRC of nothing, which is 0.
    """
    return crc32(_CRC.pack(key))


_OPEN_RESIDUE = _residue(OPEN)


class Decoder:
    """Decoder of a stream of bytes into frames; invalid frames are dropped and counted.

    `key` is that of the session; `seen` is shown every frame's bytes, valid or not.
    """

    def __init__(self, packets: Mapping[int, type[Packet]] = PACKETS, seen: Seen | None = None) -> None:
        self.invalid = 0
        self.key = OPEN
        self._reliable = {type_ for type_, cls in packets.items() if cls.reliable}
        self._texts = {type_: cls.tail[1].max_bytes for type_, cls in packets.items() if cls.tail}
        # An unknown type is longer than any frame, and so never fits one.
        self._sizes = [FRAME_BYTES_MAX] * 256
        for type_, cls in packets.items():
            self._sizes[type_] = cls.layout.size
        self._seen = seen
        self._pending = b""

    @property
    def key(self) -> int:
        """The key of the session's frames."""
        return self._key

    @key.setter
    def key(self, key: int) -> None:
        self._key = key
        self._residues = {_residue(OPEN), _residue(key)}

    def feed(self, data: bytes) -> Iterator[Frame]:
        """Yield the frames that these bytes complete, in order; another key counts from the next one on."""
        parts = (self._pending + data).split(b"\0")
        # Of what is too long for a frame the head is enough to tell; garbage must not fill the memory.
        self._pending = parts.pop()[:FRAME_BYTES_MAX]
        for stuffed in parts:
            if not stuffed:
                continue  # two zeros in a row: an idle line, nothing lost
            if self._seen is not None:
                self._seen(stuffed[:FRAME_BYTES_MAX])
            frame = self._parse(stuffed)
            if frame is None:
                self.invalid += 1
            else:
                yield frame

    def _parse(self, stuffed: bytes) -> Frame | None:
        """Return the frame between two zeros; None where it is damaged in any way."""
        if len(stuffed) >= FRAME_BYTES_MAX:
            return None
        try:
            content = unstuff(stuffed)
        except DecodeError:
            return None
        residue = crc32(content)
        if residue not in self._residues or len(content) < _CONTENT_BYTES_MIN:
            return None
        control = content[0]
        end = len(content) - _CRC.size
        reliable = content[1] in self._reliable
        if reliable:
            number = control >> 4
        else:
            end -= 1
            number = (control & 0xF0) << 4 | content[end]
        sizes = self._sizes
        messages: list[tuple[int, bytes]] = []
        at = 1
        while at < end:
            type_ = content[at]
            start = at + 1
            at = start + sizes[type_]
            if type_ in self._texts:
                if at >= end or content[at] > self._texts[type_]:
                    return None
                at += 1 + content[at]
            if at > end:
                return None
            messages.append((type_, content[start:at]))
        if not messages:
            return None
        return Frame(number, control & 15, reliable, residue == _OPEN_RESIDUE, tuple(messages))
