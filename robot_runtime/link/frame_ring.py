"""The last frames each way, for the log when something has gone wrong."""

from collections import deque

_FRAMES = 100


class FrameRing:
    """Keeps the last hundred frames sent and the last hundred received, with their times (s)."""

    def __init__(self) -> None:
        self._sent: deque[tuple[float, bytes]] = deque(maxlen=_FRAMES)
        self._received: deque[tuple[float, bytes]] = deque(maxlen=_FRAMES)

    def add_sent(self, frame: bytes, now: float) -> None:
        """Note a frame that was handed to the line."""
        self._sent.append((now, frame.removesuffix(b"\0")))

    def add_received(self, frame: bytes, now: float) -> None:
        """Note what came between two zeros, valid or not."""
        self._received.append((now, frame))

    def dump(self) -> str:
        """Both ways in the order of time, a line a frame, as stuffed bytes in hexadecimal."""
        frames = [(time, "<-", frame) for time, frame in self._received]
        frames += [(time, "->", frame) for time, frame in self._sent]
        return "\n".join(f"{time:.3f} {way} {frame.hex()}" for time, way, frame in sorted(frames))
