"""Explains recorded frames: their contents, or why they are invalid."""

import zlib
from dataclasses import dataclass
from struct import Struct

from cobs import cobs

from robot_runtime.contract.packets import FRAME_BYTES_MAX, PACKETS
from robot_runtime.link.frame_ring import RecordedFrame
from robot_runtime.link.framing import OPEN

_CRC = Struct("<I")


@dataclass(frozen=True, slots=True, kw_only=True)
class Dissection:
    """The parts of one frame. Where `problem` is not empty, the frame was discarded and the rest is a guess.

    `time` (s, steady clock) is when it was handed to the line or taken from it; `sent` means to the board.
    `bytes` is the frame on the line with its closing zero, in hexadecimal; `kinds` names its messages.
    A `reliable` frame is repeated until it is acknowledged; an `open` one belongs to no session. `number` is
    its own, of 16 reliable or 4096 unreliable ones, and `acknowledged` the reliable frame that its sender
    waits for; both are null where the frame is too damaged to have any.
    """

    time: float
    sent: bool
    bytes: str
    kinds: list[str]
    reliable: bool
    open: bool
    number: int | None
    acknowledged: int | None
    problem: str


def dissect(frame: RecordedFrame) -> Dissection:
    """Return the contents of a frame; never raises."""
    try:
        content = cobs.decode(frame.stuffed)
    except cobs.DecodeError:
        return _undecodable(frame, "its stuffing (COBS) is damaged: bytes were lost or changed")
    if len(frame.stuffed) >= FRAME_BYTES_MAX:
        return _undecodable(frame, f"longer than {FRAME_BYTES_MAX} bytes: a closing zero was lost")
    if len(content) < 2 + _CRC.size:
        return _undecodable(frame, "too short: its beginning or a part was lost")
    body = content[: -_CRC.size]
    key = _CRC.unpack_from(content, len(body))[0] ^ zlib.crc32(body)
    first = PACKETS.get(body[1])
    reliable = first is not None and first.reliable
    kinds, fits = _kinds(body[1:] if reliable else body[1:-1])
    problem = ""
    if key not in (OPEN, frame.key):
        problem = "wrong checksum: bytes were changed, or it belongs to another session"
    elif not fits:
        problem = "a message of unknown kind or wrong length: the firmware is of other definitions"
    return Dissection(
        time=frame.time,
        sent=frame.sent,
        bytes=frame.stuffed.hex() + "00",
        kinds=kinds,
        reliable=reliable,
        open=key == OPEN,
        number=body[0] >> 4 if reliable else (body[0] >> 4) << 8 | body[-1],
        acknowledged=body[0] & 15,
        problem=problem,
    )


def _kinds(messages: bytes) -> tuple[list[str], bool]:
    """Return the names of these messages as far as known, and True if they fill the bytes exactly."""
    kinds: list[str] = []
    at = 0
    while at < len(messages):
        packet = PACKETS.get(messages[at])
        if packet is None:
            return kinds, False
        end = at + 1 + packet.layout.size
        if packet.tail:
            if end >= len(messages):
                return kinds, False
            end += 1 + messages[end]
        if end > len(messages):
            return kinds, False
        kinds.append(packet.__name__)
        at = end
    return kinds, bool(kinds)


def _undecodable(frame: RecordedFrame, problem: str) -> Dissection:
    return Dissection(
        time=frame.time,
        sent=frame.sent,
        bytes=frame.stuffed.hex() + "00",
        kinds=[],
        reliable=False,
        open=False,
        number=None,
        acknowledged=None,
        problem=problem,
    )
