"""A camera that plays a video file at its own rate in a loop, or shows a picture file."""

from pathlib import Path

import cv2
import numpy as np

from robot_runtime.clock import Clock
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame
from robot_runtime.vision.picture import Picture

HINT = "name a video or a picture in robot.toml: [vision] file"


class FileCamera(Camera):
    """Plays a file, scaled to `width` × `height` pixels. Raises CameraError if it cannot be opened."""

    def __init__(self, file: Path, width: int, height: int, clock: Clock) -> None:
        if not file.is_file():
            raise CameraError(f"there is no file {str(file)!r}; {HINT}")
        self._file = file
        self._size = (width, height)
        self._clock = clock
        self._still = cv2.imread(str(file), cv2.IMREAD_COLOR) if cv2.haveImageReader(str(file)) else None
        self._video: cv2.VideoCapture | None = None
        if self._still is None:
            self._open_video()

    def read(self) -> CameraFrame:
        """Returns the picture that is due now. Raises CameraError if the video cannot be decoded."""
        now = self._clock.now()
        picture = self._still if self._still is not None else self._picture_due(now)
        scaled = cv2.resize(picture, self._size, interpolation=cv2.INTER_AREA)
        return CameraFrame(scaled.astype(np.uint8, copy=False), now)

    def close(self) -> None:
        """Closes the file."""
        if self._video is not None:
            self._video.release()

    def __str__(self) -> str:
        return f"file {self._file.name}"

    def _open_video(self) -> None:
        self.close()
        self._video = cv2.VideoCapture(str(self._file))
        if not self._video.isOpened():
            raise CameraError(
                f"{self._file.name} is neither a video nor a picture that OpenCV can read; {HINT}"
            )
        self._rate = self._video.get(cv2.CAP_PROP_FPS)
        self._started = self._clock.now()
        self._shown = 0

    def _picture_due(self, now: float) -> Picture:
        assert self._video is not None
        due = int((now - self._started) * self._rate)
        while self._shown < due and self._video.grab():
            self._shown += 1
        ok, picture = self._video.read()
        if not ok:
            self._open_video()
            ok, picture = self._video.read()
        if not ok:
            raise CameraError(f"{self._file.name} holds no picture that OpenCV can decode; {HINT}")
        self._shown += 1
        return picture.astype(np.uint8, copy=False)
