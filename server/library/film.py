"""The film of a session: what there is of it, and parts of it as MP4 files.

Pictures of H.264 are only packed anew. JPEG files, which a robot without PyAV records, are coded first.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from fractions import Fraction
from io import BytesIO
from itertools import chain, dropwhile, pairwise, takewhile
from math import inf
from struct import Struct
from typing import IO, TYPE_CHECKING, Any

from pydantic import Field

from robot_runtime.contract.film_picture import FilmPicture
from robot_runtime.contract.topics import FILM, THUMBNAIL
from server.library.content import Recording
from server.platform.errors import NotFoundError, UnavailableError
from server.platform.schema_base import Schema

if TYPE_CHECKING:
    import av

Picture = tuple[float, FilmPicture]
"""Its time (s, steady clock), and the picture."""

PART_SECONDS_MAX = 60.0
SPANS_SHOWN = 100
"""Times of a film in one answer; beyond that the shortest pauses count as filmed."""
GAP_SECONDS = 2.0
"""s between two pictures from which on the film counts as interrupted."""
KEY_SECONDS_MAX = 5.0
"""s before a moment within which the key picture is sought from which it can be shown."""
LAST_SECONDS = 1 / 15
"""s for which the last picture is shown."""
SUBTITLE_SECONDS = 0.5
"""s for which one subtitle is shown."""
_TEXT_BYTES = Struct(">H")
"""The length before the text of a subtitle (3GPP TS 26.245, 5.17)."""
_CRF = 23
"""x264's rate factor for pictures that were JPEG files."""
THUMBNAIL_WIDTH = 160
"""px"""
_MICROSECONDS = 1_000_000
_FRAGMENTED = {
    "movflags": "frag_keyframe+empty_moov+default_base_moof",
    "video_track_timescale": str(_MICROSECONDS),
}
"""Written forward only, cut off it plays to its end, and a browser adds it to others."""


class NoFilmError(NotFoundError):
    """The session has no film there"""


class CodecMissingError(UnavailableError):
    """This computer cannot read films"""

    def __init__(self) -> None:
        super().__init__(
            "Films need the package av (PyAV), which is not installed here. Install it where µ-CAT is "
            "installed, with `pip install av`, or take the session's archive to a computer that has it."
        )


class FilmSpan(Schema):
    """A time without a gap, s since the session's start."""

    start: float
    end: float


class FilmDescription(Schema):
    """The film of a session: its times, the number of its pictures, and their coding."""

    spans: list[FilmSpan]
    pictures: int
    codec: str = Field(description='of its parts as browsers name it, such as "avc1.42c016"')


def describe_film(recording: Recording) -> FilmDescription:
    """Return what there is of a film. Raise NoFilmError, CodecMissingError, StoreError, RecordingError."""
    chunks = recording.spans(FILM.name)
    spans = _join([(first, last) for first, last, _ in chunks], recording.row.started_steady)
    _, first_picture = next(film_from(recording, -inf, inf))
    (_, shown), *_ = as_h264([(0.0, first_picture)])
    if not shown.codec:
        raise ValueError("its first picture does not say how it is coded")
    pictures = sum(count for _, _, count in chunks)
    return FilmDescription(spans=spans, pictures=pictures, codec=shown.codec)


def _join(chunks: list[tuple[float, float]], zero: float) -> list[FilmSpan]:
    """Return the times of chunks without the short pauses between them, s since `zero`."""
    pauses = sorted((start - end for (_, end), (start, _) in pairwise(chunks)), reverse=True)
    shortest = max([GAP_SECONDS, *pauses[SPANS_SHOWN - 1 : SPANS_SHOWN]])
    spans = list[FilmSpan]()
    for start, end in chunks:
        if spans and start - zero - spans[-1].end <= shortest:
            spans[-1].end = end - zero
        else:
            spans.append(FilmSpan(start=start - zero, end=end - zero))
    return spans


def film_from(recording: Recording, start: float, end: float) -> Iterator[Picture]:
    """Yield the pictures from the one that is shown at `start` up to `end` (s, steady clock).

    It begins with the key picture on which that builds, or else with the next one. Raise NoFilmError,
    StoreError, RecordingError.
    """
    key = start
    for time, picture in _read(recording, start - KEY_SECONDS_MAX, start):
        if picture.is_key:
            key = time
    pictures = dropwhile(lambda item: not item[1].is_key, _read(recording, key, end))
    first = next(pictures, None)
    if first is None:
        raise NoFilmError("The camera was not filmed there, or the film was deleted to make room.")
    return chain([first], pictures)


def as_h264(pictures: Iterable[Picture]) -> Iterator[Picture]:
    """Yield the pictures, JPEG files as H.264. Raise CodecMissingError."""
    coder: Any = None
    for time, picture in pictures:
        if not picture.is_jpeg:
            yield time, picture
            continue
        frame = _decode(picture)
        if coder is None:
            from robot_runtime.vision.h264 import H264Coder

            coder = H264Coder(1 / LAST_SECONDS, _CRF, (frame.width, frame.height))
        yield time, FilmPicture(coder.code(time, frame))


def decode_film(pictures: Iterable[Picture]) -> "Iterator[tuple[float, av.VideoFrame]]":
    """Yield time (s) and picture of a film that begins with a key picture; damaged ones are left out.

    Raise CodecMissingError.
    """
    try:
        import av
    except ImportError as problem:
        raise CodecMissingError from problem
    decoder: av.VideoCodecContext | None = None
    unit = Fraction(1, _MICROSECONDS)
    for time, picture in pictures:
        if picture.is_jpeg:
            with suppress(ValueError):
                yield time, _decode(picture)
            continue
        if decoder is None:
            decoder = _open_decoder()
        packet = av.Packet(bytes(picture))
        packet.pts, packet.time_base = round(time * _MICROSECONDS), unit
        with suppress(av.FFmpegError):
            yield from _timed(decoder.decode(packet))
    if decoder is not None:
        with suppress(av.FFmpegError):
            yield from _timed(decoder.decode(None))


def _timed(frames: "Iterable[av.VideoFrame]") -> "Iterator[tuple[float, av.VideoFrame]]":
    return (((frame.pts or 0) / _MICROSECONDS, frame) for frame in frames)


def _open_decoder() -> "av.VideoCodecContext":
    import av

    decoder = av.CodecContext.create("h264", "r")
    assert isinstance(decoder, av.VideoCodecContext)
    # With more, each picture would come some pictures later.
    decoder.thread_count = 1
    return decoder


def write_mp4(
    pictures: Iterator[Picture], output: IO[bytes], subtitle: Callable[[float], str] | None = None
) -> None:
    """Write pictures as a fragmented MP4 file that begins with the time of the first, a key picture.

    `subtitle` gives the text that is shown from a time (s, steady clock) on. Raise CodecMissingError.
    """
    try:
        import av
    except ImportError as problem:
        raise CodecMissingError from problem
    coded = as_h264(pictures)
    origin, first = next(coded)
    shown = _decode(first)
    unit = Fraction(1, _MICROSECONDS)
    with av.open(output, "w", format="mp4", options=_FRAGMENTED) as file:
        stream = file.add_mux_stream("h264", rate=15, width=shown.width, height=shown.height)
        texts: Any = None if subtitle is None else file.add_mux_stream("mov_text")
        last, text_due = -1, origin
        for time, picture in chain([(origin, first)], coded):
            packet = av.Packet(picture)
            packet.stream, packet.time_base = stream, unit
            # The file takes no two pictures of one time, and later ones build on each.
            last = max(last + 1, round((time - origin) * _MICROSECONDS))
            packet.pts = packet.dts = last
            # It counts for the last one alone.
            packet.duration = round(LAST_SECONDS * _MICROSECONDS)
            packet.is_keyframe = picture.is_key
            file.mux(packet)
            if subtitle is not None and time >= text_due:
                text_due = time + SUBTITLE_SECONDS
                text = subtitle(time).encode()
                shown_text = av.Packet(_TEXT_BYTES.pack(len(text)) + text)
                shown_text.stream, shown_text.time_base = texts, unit
                shown_text.pts = shown_text.dts = last
                shown_text.duration = round(SUBTITLE_SECONDS * _MICROSECONDS)
                shown_text.is_keyframe = True
                file.mux(shown_text)


def film_part(recording: Recording, start: float, seconds: float) -> tuple[float, bytes]:
    """Return the time of a part's first picture (s, steady clock), and the part as a fragmented MP4 file.

    It ends before a key picture: pictures that build on one which another part replaces, a browser forgets.
    Raise NoFilmError, CodecMissingError, StoreError, RecordingError.
    """
    pictures = film_from(recording, start, inf)
    origin, first = next(pictures)
    end = start + seconds
    whole = takewhile(lambda item: item[0] < end or not item[1].is_key, pictures)
    output = BytesIO()
    write_mp4(chain([(origin, first)], whole), output)
    return origin, output.getvalue()


def small_picture(recording: Recording, time: float) -> bytes | None:
    """Return the first thumbnail from `time` (s, steady clock) on, a JPEG file; None without one.

    Of a session that has none it is made of the film: of the key picture before, or else of the next one.
    Raise NoFilmError, CodecMissingError, StoreError, RecordingError, ValueError where it is damaged.
    """
    for _, jpeg in recording.pictures(THUMBNAIL.name, time):
        return jpeg
    if recording.has(THUMBNAIL.name) or not recording.has(FILM.name):
        return None
    _, picture = next(film_from(recording, time, inf))
    frame = _decode(picture)
    import av

    width = THUMBNAIL_WIDTH
    height = max(2, round(frame.height * width / frame.width / 2) * 2)
    coder = av.CodecContext.create("mjpeg", "w")
    assert isinstance(coder, av.VideoCodecContext)
    coder.width, coder.height, coder.pix_fmt = width, height, "yuvj420p"
    coder.time_base = Fraction(1, _MICROSECONDS)
    small = frame.reformat(width, height, "yuvj420p")
    return b"".join(bytes(packet) for packet in [*coder.encode(small), *coder.encode(None)])


def _read(recording: Recording, start: float, end: float) -> Iterator[Picture]:
    """Yield the pictures; after missing ones it goes on with one that can be shown without them."""
    following, lost = None, False
    for number, time, data in recording.numbered_film(start, end):
        picture = FilmPicture(data)
        lost = (lost or following not in (None, number)) and not picture.is_key
        following = number + 1
        if not lost:
            yield time, picture


def _decode(picture: FilmPicture) -> "av.VideoFrame":
    """Return a key picture, decoded. Raise CodecMissingError, ValueError where it is damaged."""
    try:
        import av
    except ImportError as problem:
        raise CodecMissingError from problem
    decoder = av.CodecContext.create("mjpeg" if picture.is_jpeg else "h264", "r")
    assert isinstance(decoder, av.VideoCodecContext)
    try:
        frames = [*decoder.decode(av.Packet(bytes(picture))), *decoder.decode(None)]
    except av.FFmpegError as problem:
        raise ValueError(f"a picture of the film is damaged: {problem}") from problem
    if not frames:
        raise ValueError("a picture of the film is damaged")
    return frames[0]
