"""Messages between the runtime and its vision process, over a pair of sockets.

    message := bytes of the table u32 | bytes of the attachment u32 | table | attachment    (little-endian)

The table is a JSON object; the attachment is a JPEG file or nothing.
"""

import json
import socket
import time
from select import select
from struct import Struct
from typing import Any, NamedTuple

_HEADER = Struct("<II")
_READ_BYTES = 65_536
LONGEST = 16_000_000
"""Bytes of a table or an attachment at most: no picture has more, and what a damaged process says may."""


class MessageError(Exception):
    """Bytes from the other end that are no message."""


class VisionMessage(NamedTuple):
    """A JSON object, and a file that belongs to it."""

    table: dict[str, Any]
    attachment: bytes


class MessageSocket:
    """One end of the connection. One thread receives; whoever sends waits for the others."""

    def __init__(self, end: socket.socket) -> None:
        self._end = end
        self._end.setblocking(False)
        self._received = bytearray()

    def close(self) -> None:
        """Close this end; the other one reads its end."""
        self._end.close()

    def send(self, table: dict[str, Any], attachment: bytes = b"") -> None:
        """Send a message, and wait until the other end has room for it. Raise OSError if that is gone."""
        rest = memoryview(_pack(table, attachment))
        while rest:
            try:
                rest = rest[self._end.send(rest) :]
            except BlockingIOError:
                select([], [self._end], [])

    def send_at_once(self, table: dict[str, Any]) -> bool:
        """Send a message without waiting. Raise OSError if the other end is gone.

        Return False where there was no room for all of it: then nothing may be sent any more.
        """
        data = _pack(table, b"")
        try:
            return self._end.send(data) == len(data)
        except BlockingIOError:
            return False

    def receive(self, timeout: float) -> list[VisionMessage]:
        """Return all messages that have come, waiting up to `timeout` s for the first; [] if none came.

        Raise EOFError when the other end is closed, and MessageError.
        """
        end = time.monotonic() + timeout
        while not (messages := self._take()):
            readable, _, _ = select([self._end], [], [], max(end - time.monotonic(), 0.0))
            if not readable:
                return []
            try:
                data = self._end.recv(_READ_BYTES)
            except ConnectionError as problem:
                raise EOFError from problem
            if not data:
                raise EOFError
            self._received += data
        return messages

    def _take(self) -> list[VisionMessage]:
        messages, data, start = [], self._received, 0
        while len(data) >= start + _HEADER.size:
            sizes = _HEADER.unpack_from(data, start)
            if max(sizes) > LONGEST:
                raise MessageError(f"a message of {max(sizes)} bytes")
            middle = start + _HEADER.size + sizes[0]
            if len(data) < middle + sizes[1]:
                break
            messages.append(_unpack(data[start + _HEADER.size : middle], data[middle : middle + sizes[1]]))
            start = middle + sizes[1]
        del data[:start]
        return messages


def _pack(table: dict[str, Any], attachment: bytes) -> bytes:
    text = json.dumps(table).encode()
    return _HEADER.pack(len(text), len(attachment)) + text + attachment


def _unpack(text: bytearray, attachment: bytearray) -> VisionMessage:
    try:
        table = json.loads(text)
    except (ValueError, RecursionError) as problem:
        raise MessageError("a table that is no JSON") from problem
    if not isinstance(table, dict):
        raise MessageError("a table that is no JSON object")
    return VisionMessage(table, bytes(attachment))
