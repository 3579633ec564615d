"""MCAP for Foxglove and Lichtblick: our topics as JSON, and the well-known topics of their panels.

Not compressed unless asked for: a Raspberry Pi Zero lacks the packages for it. Message times are UTC.
"""

import base64
import heapq
import json
import re
from collections.abc import Iterator
from functools import partial
from importlib import import_module
from itertools import repeat
from typing import Any, BinaryIO

from sqlmodel import col, select

from robot_runtime.contract import topics
from robot_runtime.contract.film_picture import FilmPicture
from server.features.exports.description import craft_files, describe_session, dump_readable
from server.features.exports.schemas import Compression
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.features.exports.values import Rows
from server.interchange.foxglove_messages import (
    Message,
    body_transform,
    compressed_image,
    compressed_video,
    log_line,
    pose_in_frame,
    world_transform,
)
from server.interchange.mcap_schemas import WELL_KNOWN, topic_schema
from server.interchange.plain_schema import without_null
from server.interchange.pose_tracker import PoseTracker
from server.library.content import depth_loop
from server.library.crafts import read_crafts, which_water
from server.platform.models import BookmarkRow
from server.platform.store import Reader

LIBRARY = "mucat"
LOG, TRANSFORMS, FRAMES, POSE, CAMERA = "/log", "/tf", "/tf_static", "/pose", "/camera"
IMAGE, VIDEO = "foxglove.CompressedImage", "foxglove.CompressedVideo"
PACKAGES = {"zstd": "zstandard", "lz4": "lz4"}
ABSENT = re.compile(rb',"\w+":null')
"""A member of a row that is NaN: schemas that Foxglove reads know no null."""
ENCODE = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode

_Sample = tuple[int, int, bytes, dict[str, Any] | None]
"""Time (ns, UTC); the topic's place, so that equal times stay in one order; the message; and its entry in the
log, if any."""


def check_mcap() -> None:
    """Raise ExportRequestError if the package mcap is missing."""
    try:
        import mcap.writer  # noqa: F401
    except ImportError as problem:
        raise ExportRequestError(
            "MCAP needs the package mcap, which is not installed. Install it where µ-CAT is installed, with "
            "`pip install --no-deps mcap`, or choose another format."
        ) from problem


def check_compression(name: Compression) -> None:
    """Raise ExportRequestError if the package for this compression is missing."""
    package = PACKAGES[name]
    try:
        import_module(package)
    except ImportError as problem:
        raise ExportRequestError(
            f"Compression by {name} needs the package {package}, which is not installed. Install it where "
            f"µ-CAT is installed, with `pip install {package}`, or export without compression."
        ) from problem


def write_mcap(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write a channel for each topic, `/log`, `/tf`, `/tf_static`, `/pose`, `/camera`, metadata, attachments.

    Raise ExportRequestError, StoreError, RecordingError.
    """
    check_mcap()
    from mcap.writer import CompressionType, Writer

    compression = CompressionType[source.options.compression.upper()]
    writer = Writer(output, compression=compression, enable_data_crcs=True)
    writer.start(profile="", library=LIBRARY)
    _write_about(store, source, writer)
    channels = _Channels(writer)
    first = source.utc_ns(source.row.started_steady)
    tracker, posing = _pose_tracker(source)
    if posing:
        channels.add(FRAMES, "foxglove.FrameTransform", first, world_transform(first))
    own = [channels.of(source, name) for name in source.names]
    for time, index, data, document in heapq.merge(*_samples(store, source)):
        if index < len(own):
            writer.add_message(own[index], time, data, time)
        if index in posing:
            pose = tracker.see(source.names[index], time, partial(_read_field, data))
            if pose:
                channels.add(TRANSFORMS, "foxglove.FrameTransform", time, body_transform(time, pose))
                channels.add(POSE, "foxglove.PoseInFrame", time, pose_in_frame(time, pose))
        elif document is not None:
            channels.add(LOG, "foxglove.Log", time, log_line(time, document["topic"], document))
    writer.finish()  # type: ignore[no-untyped-call]


class _Channels:
    """The well-known topics, opened when they are first used."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self._numbers: dict[str, int] = {}

    def of(self, source: ExportSelection, name: str) -> int:
        described = source.topics[name]
        if described["kind"] == "picture":
            return self.open(CAMERA, IMAGE, WELL_KNOWN[IMAGE])
        if described["kind"] == "film":
            _, first = next(source.film(source.start, source.end), (0.0, b""))
            message = IMAGE if FilmPicture(first).is_jpeg else VIDEO
            return self.open(f"/{name}", message, WELL_KNOWN[message])
        return self.open(f"/{name}", f"mucat.{name}", topic_schema(name, described))

    def open(self, topic: str, name: str, schema: dict[str, Any]) -> int:
        number = self._writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
        return int(self._writer.register_channel(topic, "json", number))

    def add(self, topic: str, name: str, time: int, message: Message) -> None:
        if topic not in self._numbers:
            self._numbers[topic] = self.open(topic, name, WELL_KNOWN[name])
        self._writer.add_message(self._numbers[topic], time, _dump(message), time)


def _pose_tracker(source: ExportSelection) -> tuple[PoseTracker, set[int]]:
    """Return the tracker and the places of the topics that it needs; none where the attitude is unknown.

    The attitude is the IMU's; without one, the simulated body's.
    """
    imu, depth, truth = topics.IMU.name, topics.DEPTH.name, topics.TRUTH.name
    attitude = imu if imu in source.names else truth
    tracker = PoseTracker(attitude)
    if attitude not in source.names:
        return tracker, set()
    position = truth if truth in source.names else depth
    if position not in source.names:
        tracker.see(depth, 0, {"depth": 0.0}.get)
    return tracker, {index for index, name in enumerate(source.names) if name in (attitude, position)}


def _read_field(data: bytes, name: str) -> Any:
    return json.loads(data).get(name)


def _dump(message: Message) -> bytes:
    return ENCODE(message).encode()


def _write_about(store: Reader, source: ExportSelection, writer: Any) -> None:
    row = source.row
    described = describe_session(store, source)
    about = (
        "identifier",
        "name",
        "robot",
        "version",
        "definitions",
        "firmware",
        "software",
        "scenario_name",
        "seed",
    )
    texts = {name: "" if described[name] is None else str(described[name]) for name in about}
    writer.add_metadata("session", texts)
    writer.add_metadata("configuration", {"robot.toml": row.configuration, "scenario": row.scenario})
    crafts = read_crafts(source)
    writer.add_metadata(
        "craft",
        {
            "water": which_water(set(source.counts())),
            "title": ", then ".join(craft.title for craft in crafts),
        },
    )
    writer.add_metadata("gains", _gains(described["robot_state"]))
    first = source.utc_ns(row.started_steady)
    attached = [("session.json", "application/json", dump_readable(described))]
    attached.append(("robot.toml", "application/toml", row.configuration))
    if row.scenario:
        attached.append(("scenario.toml", "application/toml", row.scenario))
    attached += [(name, "application/toml", text) for name, text in craft_files(crafts)]
    for name, kind, text in attached:
        writer.add_attachment(first, first, name, kind, text.encode())


def _gains(state: dict[str, Any] | None) -> dict[str, str]:
    """Return the gains at the start of the session, such as "pid.kp", and the chosen controller."""
    loop = depth_loop(state or {})
    gains = {
        f"{controller['name']}.{gain['name']}": str(gain["value"])
        for controller in loop.get("controllers", [])
        for gain in controller.get("gains", [])
    }
    return {"controller": str(loop.get("controller", "")), **gains}


def _samples(store: Reader, source: ExportSelection) -> list[Iterator[_Sample]]:
    readers = {"rows": _rows, "documents": _documents, "picture": _pictures, "film": _film}
    streams = [
        readers[source.topics[name]["kind"]](source, name, index) for index, name in enumerate(source.names)
    ]
    return [*streams, _bookmarks(store, source)]


def _rows(source: ExportSelection, name: str, index: int) -> Iterator[_Sample]:
    rows = Rows(source, name)
    for times, columns in rows.batches():
        since = [source.since_start(time) for time in times]
        lines = [
            ABSENT.sub(b"", line) if b"null" in line else line
            for line in rows.lines('"time":%.6f', [since], columns)
        ]
        yield from zip(map(source.utc_ns, times), repeat(index), lines, repeat(None))


def _documents(source: ExportSelection, name: str, index: int) -> Iterator[_Sample]:
    for document in source.documents(name, source.start, source.end):
        time = source.utc_ns(document["time"])
        data = _dump({**without_null(document), "time": round(source.since_start(document["time"]), 6)})
        yield (time, index, data, {**document, "topic": name} if name in topics.LINES else None)


def _pictures(source: ExportSelection, name: str, index: int) -> Iterator[_Sample]:
    for moment, jpeg in source.pictures(name, source.start, source.end):
        time = source.utc_ns(moment)
        image = compressed_image(time, base64.b64encode(jpeg).decode())
        yield (time, index, _dump(image), None)


def _film(source: ExportSelection, name: str, index: int) -> Iterator[_Sample]:  # noqa: ARG001
    for moment, picture in source.film(source.start, source.end):
        time, data = source.utc_ns(moment), base64.b64encode(picture).decode()
        make = compressed_image if FilmPicture(picture).is_jpeg else compressed_video
        yield (time, index, _dump(make(time, data)), None)


def _bookmarks(store: Reader, source: ExportSelection) -> Iterator[_Sample]:
    query = select(BookmarkRow).where(BookmarkRow.session_id == source.row.id).order_by(col(BookmarkRow.time))
    with store.read() as database:
        bookmarks = database.exec(query).all()
    for bookmark in bookmarks:
        if source.start <= bookmark.time <= source.end:
            yield (
                source.utc_ns(bookmark.time),
                len(source.names),
                b"",
                {"topic": "marker", "text": bookmark.text},
            )
