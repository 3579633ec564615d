"""The last frames in each direction, for diagnosis."""

from collections import deque
from typing import NamedTuple

_FRAMES = 100


class RecordedFrame(NamedTuple):
    """A frame as on the line, without its closing zero; `key` is that of its session, `time` in s."""

    time: float
    sent: bool
    key: int
    stuffed: bytes


class FrameRing:
    """The last hundred frames sent and the last hundred received."""

    def __init__(self) -> None:
        self._sent: deque[RecordedFrame] = deque(maxlen=_FRAMES)
        self._received: deque[RecordedFrame] = deque(maxlen=_FRAMES)

    def add_sent(self, frame: bytes, key: int, now: float) -> None:
        """Add a frame that was written to the line."""
        self._sent.append(RecordedFrame(now, True, key, frame.removesuffix(b"\0")))

    def add_received(self, frame: bytes, key: int, now: float) -> None:
        """Add the received bytes between two zeros, valid or not."""
        self._received.append(RecordedFrame(now, False, key, frame))

    def frames(self) -> list[RecordedFrame]:
        """Return the frames of both directions in order of time."""
        return sorted([*self._received, *self._sent], key=lambda frame: frame.time)

    def dump(self) -> str:
        """Return the frames for a log, one a line, as stuffed bytes in hexadecimal."""
        return "\n".join(
            f"{frame.time:.3f} {'->' if frame.sent else '<-'} {frame.stuffed.hex()}"
            for frame in self.frames()
        )
