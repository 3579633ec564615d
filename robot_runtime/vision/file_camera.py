"""A camera that plays a video file in a loop, at the times of its pictures, or shows a picture file."""

from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from pathlib import Path

import cv2
import numpy as np

from robot_runtime.clock import Clock
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame
from robot_runtime.vision.picture import Picture
from robot_runtime.vision.shape import describe_fit, fit

HINT = "name a video or a picture in robot.toml: [vision] file"
RATE_LEAST, RATE_MOST = 0.1, 240.0
"""Hz; a video that claims another rate is taken at its word no more than one that claims none."""
USUAL_RATE = 25.0
"""Hz at which such a video is played. Chosen: as most are filmed."""
PROBED = 8
"""Pictures whose times show whether a file has any."""
MILLISECONDS = 1e3


class FileCamera(Camera):
    """A camera that plays a file, fitted to `width` × `height` pixels.

    Raises CameraError if it cannot be opened.
    """

    def __init__(self, file: Path, width: int, height: int, clock: Clock) -> None:
        if not file.is_file():
            raise CameraError(f"there is no file {str(file)!r}; {HINT}")
        self._file = file
        self.size = (width, height)
        self._clock = clock
        self._started = clock.now()
        try:
            still = _read_still(file)
            self._video = None if still is not None else self._open(None)
            picture = still if self._video is None else self._video.show(0.0)
        except (cv2.error, MemoryError) as problem:
            raise CameraError(f"{file.name} cannot be decoded ({problem}); {HINT}") from problem
        if picture is None:
            raise CameraError(self._nothing)
        self._given = (picture.shape[1], picture.shape[0])
        # Made smaller once: a photograph is a hundred times as large.
        is_larger = self._given[0] > width and self._given[1] > height
        self._first = fit(picture, width, height) if is_larger else picture

    def read(self) -> CameraFrame:
        """Return the picture that is due now. Raise CameraError if the video cannot be decoded."""
        now = self._clock.now()
        if self._video is None:
            return CameraFrame(fit(self._first, *self.size), now)
        if (picture := self._video.show(now - self._started)) is None:
            # From its end it begins again.
            self._video.close()
            self._video, self._started = self._open(self._video.pace), now
            picture = self._video.show(0.0)
        if picture is None:
            raise CameraError(self._nothing)
        return CameraFrame(fit(picture, *self.size), now)

    def close(self) -> None:
        """Close the file."""
        if self._video is not None:
            self._video.close()

    def __str__(self) -> str:
        fitted = describe_fit(self._given, *self.size)
        notes = [note for note in (fitted, self._video.note if self._video else "") if note]
        return f"file {self._file.name}" + (f" ({'; '.join(notes)})" if notes else "")

    @property
    def _nothing(self) -> str:
        return f"{self._file.name} holds no picture that OpenCV can decode; {HINT}"

    def _open(self, pace: "_Pace | None") -> "_Video":
        path = str(self._file)
        pace = pace or _probe(path)
        if pace is None:
            what = "is neither a video nor a picture that OpenCV can read"
            if cv2.haveImageReader(path):
                what = "cannot be decoded: the picture is damaged, or larger than memory"
            raise CameraError(f"{self._file.name} {what}; {HINT}")
        return _Video(path, pace)


def _read_still(file: Path) -> Picture | None:
    """Return a picture file's picture, turned by its orientation tag; None for other files."""
    if not cv2.haveImageReader(str(file)):
        return None
    picture = cv2.imread(str(file), cv2.IMREAD_COLOR)
    return None if picture is None else picture.astype(np.uint8, copy=False)


@dataclass(frozen=True, slots=True)
class _Pace:
    """The pace of a video: by its pictures' own times, or at a rate (Hz), for which `note` is the reason."""

    rate: float
    timed: bool = True
    note: str = ""


def _probe(path: str) -> _Pace | None:
    """Return the pace of a video; None for a file that is no video."""
    capture = _capture(path)
    try:
        if not capture.isOpened():
            return None
        claimed = capture.get(cv2.CAP_PROP_FPS)
        times: list[float] = []
        while len(times) < PROBED and capture.grab():
            times.append(capture.get(cv2.CAP_PROP_POS_MSEC) / MILLISECONDS)
    finally:
        capture.release()
    intervals = [after - before for before, after in pairwise(times)]
    if intervals and all(interval > 0 for interval in intervals):
        rate = len(intervals) / (times[-1] - times[0])
        if RATE_LEAST <= rate <= RATE_MOST:
            return _Pace(rate)
    if RATE_LEAST <= claimed <= RATE_MOST:
        return _Pace(claimed, timed=False)
    claim = f"{claimed:.6g} pictures a second" if isfinite(claimed) and claimed > 0 else "no rate"
    return _Pace(USUAL_RATE, timed=False, note=f"says {claim}; played at {USUAL_RATE:g}")


class _Video:
    """One playing of a video file from its beginning."""

    def __init__(self, path: str, pace: _Pace) -> None:
        self.pace = pace
        self._capture = _capture(path)
        self._turned = _remaining_turn(self._capture)
        self._shown: Picture | None = None
        self._count = 0
        self._next: float | None = -1.0
        """s at which the picture is due that was read last but is not shown yet; None after the last one."""
        self._first: float | None = None
        self._end = 0.0
        self._advance()

    @property
    def note(self) -> str:
        """A note about an unusual pace; empty where it is usual."""
        return self.pace.note

    def show(self, elapsed: float) -> Picture | None:
        """Return the picture that is due `elapsed` s after the beginning; None after the end."""
        while self._next is not None and self._next <= elapsed:
            ok, picture = self._capture.retrieve()
            if ok:
                self._shown = picture.astype(np.uint8, copy=False)
            self._advance()
        if self._shown is None or (self._next is None and elapsed >= self._end):
            return None
        return self._shown if self._turned is None else cv2.rotate(self._shown, self._turned).astype(np.uint8)

    def close(self) -> None:
        """Close the file."""
        self._capture.release()

    def _advance(self) -> None:
        """Read the next picture, which is not decoded into colours before it is shown."""
        before = self._next if self._count else 0.0
        if not self._capture.grab():
            self._next, self._end = None, (before or 0.0) + 1 / self.pace.rate
            return
        due = self._count / self.pace.rate
        if self.pace.timed:
            stamp = self._capture.get(cv2.CAP_PROP_POS_MSEC) / MILLISECONDS
            self._first = stamp if self._first is None else self._first
            # A stamp that goes back, or none, is of a damaged file: its picture follows the one before.
            due = stamp - self._first if isfinite(stamp) else 0.0
        self._next = max(due, before or 0.0)
        self._count += 1


def _capture(path: str) -> cv2.VideoCapture:
    capture = cv2.VideoCapture(path)
    # A phone films lying, and notes how it was held.
    capture.set(cv2.CAP_PROP_ORIENTATION_AUTO, 1)
    return capture


def _remaining_turn(capture: cv2.VideoCapture) -> int | None:
    """Return the turn that a film still needs, where this OpenCV does not turn it itself."""
    if capture.get(cv2.CAP_PROP_ORIENTATION_AUTO) == 1:
        return None
    turns = {90: cv2.ROTATE_90_CLOCKWISE, 180: cv2.ROTATE_180, 270: cv2.ROTATE_90_COUNTERCLOCKWISE}
    return turns.get(round(capture.get(cv2.CAP_PROP_ORIENTATION_META)) % 360)
