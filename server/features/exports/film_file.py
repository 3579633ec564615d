"""The film as an MP4 file: as it was recorded, with subtitles, or with the flight view's lines drawn in."""

from collections.abc import Iterator
from importlib.util import find_spec
from itertools import chain
from typing import BinaryIO

from robot_runtime.contract.film_picture import FilmPicture
from robot_runtime.contract.topics import FILM
from server.features.exports.schemas import Overlay
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.library.film import LAST_SECONDS, Picture, decode_film, film_from, write_mp4
from server.library.flight_values import FlightReader, FlightValues, format_time
from server.platform.store import Reader

DRAWN_CRF = 21
"""x264's rate factor for pictures with lines: thin ones stay sharp."""


def check_overlay(overlay: Overlay) -> None:
    """Raise ExportRequestError where a package for it is missing."""
    needed = ("numpy", "cv2") if overlay == "lines" else ("numpy",)
    missing = [package for package in needed if find_spec(package) is None]
    if missing:
        raise ExportRequestError(
            f"Values over the film need NumPy and OpenCV, and {missing[0]} is not installed. Install them "
            "(Debian: sudo apt install python3-opencv), or export the film without."
        )


def require_film(source: ExportSelection) -> None:
    """Raise ExportRequestError where there is no film in the range."""
    if FILM.name not in source.samples:
        raise ExportRequestError(
            "The camera was not filmed then, or the film was deleted to make room. Sessions are filmed where "
            "that is chosen beside the start of a recording."
        )


def write_film(_: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write the film of the range as an MP4 file.

    Raise ExportRequestError, NoFilmError, CodecMissingError, StoreError, RecordingError.
    """
    require_film(source)
    pictures = film_from(source, source.start, source.end)
    if source.options.overlay == "none":
        write_mp4(pictures, output)
        return
    first = next(pictures)
    pictures = chain([first], pictures)
    values = FlightReader(source, first[0], source.end)
    if source.options.overlay == "lines":
        write_mp4(_draw(pictures, values), output)
    else:
        write_mp4(pictures, output, lambda time: describe(values.at(time)))


def _draw(pictures: Iterator[Picture], values: FlightReader) -> Iterator[Picture]:
    """Yield the pictures with the flight view's lines."""
    import av
    import numpy as np

    from robot_runtime.vision.h264 import H264Coder
    from server.features.exports.flight_lines import FlightLines

    coder: H264Coder | None = None
    lines: FlightLines | None = None
    for time, frame in decode_film(pictures):
        if coder is None or lines is None:
            coder = H264Coder(1 / LAST_SECONDS, DRAWN_CRF, (frame.width, frame.height))
            lines = FlightLines(frame.width, frame.height)
        picture = frame.to_ndarray(format="bgr24").astype(np.uint8, copy=False)
        lines.draw(picture, values.at(time))
        yield time, FilmPicture(coder.code(time, av.VideoFrame.from_ndarray(picture, format="bgr24")))


def describe(values: FlightValues) -> str:
    """Return the values of a moment as lines of text."""
    parts = [format_time(values.time)]
    if values.depth is not None:
        parts.append(f"{values.depth:z.2f} m")
    if values.depth_held is not None:
        parts.append(f"set {values.depth_held:.2f} m")
    if values.attitude is not None:
        parts.append(f"{round(values.attitude.heading) % 360:03d}°")
    parts.append("ARMED" if values.armed else "")
    parts.append(
        f"{values.mode} {values.controller.replace('_', '-')}".strip() if values.armed else values.mode
    )
    alarms = [f"! {alarm}" for alarm in values.alarms]
    return "\n".join(filter(None, ["  ".join(filter(None, parts)), *alarms, values.event]))
