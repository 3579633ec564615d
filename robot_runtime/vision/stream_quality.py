"""Quality of the camera's stream: it falls before the rate does, and rises again when there is room."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StreamStep:
    """A quality of the stream: the share of its configured size, and the quality of its JPEG files."""

    scale: float
    quality: int


STEPS = (StreamStep(1.0, 80), StreamStep(1.0, 60), StreamStep(0.75, 60), StreamStep(0.5, 50))
"""From the best to the least."""
BYTES_MAX = 120_000
"""Of a picture; a larger one costs a step. At 15 Hz it is 1.8 MB/s, what Wi-Fi carries at some distance."""
BUSY_MAX, BUSY_ROOM = 0.9, 0.5
"""Share of a picture's period that making it may take, and below which there is room for a better one."""
WEIGHT, SHARE_MAX = 0.1, 2.0
"""Of the newest picture in the mean of that share, and the most that a single picture counts."""
ROOM_SECONDS = 5.0
"""s of such room before the next better step."""


class StreamQuality:
    """The present step of a stream of `rate` Hz."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._at = 0
        self._busy = (BUSY_MAX + BUSY_ROOM) / 2
        self._roomy_since: float | None = None

    @property
    def step(self) -> StreamStep:
        """The step for the next picture."""
        return STEPS[self._at]

    def take(self, now: float, seconds: float, size: int) -> None:
        """Take the s that a picture of `size` bytes took to make and send, at `now` (s)."""
        self._busy += WEIGHT * (min(seconds * self._rate, SHARE_MAX) - self._busy)
        if self._busy > BUSY_MAX or size > BYTES_MAX:
            self._change(+1)
        elif self._busy >= BUSY_ROOM or size > BYTES_MAX / 2:
            self._roomy_since = None
        elif self._roomy_since is None:
            self._roomy_since = now
        elif now - self._roomy_since >= ROOM_SECONDS:
            self._change(-1)

    def _change(self, steps: int) -> None:
        self._at = min(max(self._at + steps, 0), len(STEPS) - 1)
        self._busy = (BUSY_MAX + BUSY_ROOM) / 2
        self._roomy_since = None
