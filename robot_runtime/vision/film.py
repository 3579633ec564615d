"""The film: pictures of the camera, coded one by one as they come.

Where PyAV is, they are H.264; elsewhere JPEG files, which are some five times as large.
"""

from typing import TYPE_CHECKING, Protocol

import cv2

from robot_runtime.contract.commands import FilmQuality
from robot_runtime.vision.shape import fit

if TYPE_CHECKING:
    from robot_runtime.vision.picture import Picture

CRF: dict[FilmQuality, int] = {"low": 32, "medium": 26, "high": 20}
"""x264's constant rate factor."""
JPEG_QUALITY: dict[FilmQuality, int] = {"low": 50, "medium": 70, "high": 90}


class FilmCoder(Protocol):
    """A coder of the pictures of one film, which are all of one size."""

    def code(self, taken: float, picture: "Picture") -> bytes:
        """Return the picture that was taken at this time (s), coded."""


def open_coder(rate: float, quality: FilmQuality, size: tuple[int, int]) -> FilmCoder:
    """Return the best coder there is: `rate` in Hz, `size` is width and height."""
    try:
        return H264FilmCoder(rate, quality, size)
    except ImportError:
        return JpegFilmCoder(quality, size)


class JpegFilmCoder:
    """A coder that needs no library of its own."""

    def __init__(self, quality: FilmQuality, size: tuple[int, int]) -> None:
        self._quality = JPEG_QUALITY[quality]
        self._size = size

    def code(self, taken: float, picture: "Picture") -> bytes:  # noqa: ARG002
        """Return the picture as a JPEG file."""
        settings = [cv2.IMWRITE_JPEG_QUALITY, self._quality]
        _, jpeg = cv2.imencode(".jpg", fit(picture, *self._size), settings)
        return jpeg.tobytes()


class H264FilmCoder:
    """A coder by x264. Raise ImportError where PyAV is not there."""

    def __init__(self, rate: float, quality: FilmQuality, size: tuple[int, int]) -> None:
        from robot_runtime.vision.h264 import H264Coder

        self._coder = H264Coder(rate, CRF[quality], size)

    def code(self, taken: float, picture: "Picture") -> bytes:
        """Return the picture as one access unit."""
        import av

        return self._coder.code(
            taken, av.VideoFrame.from_ndarray(fit(picture, *self._coder.size), format="bgr24")
        )
