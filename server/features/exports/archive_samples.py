"""Checks the samples in an archive's chunks: number, times, and documents as this version reads them."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from math import isfinite
from typing import Any

from robot_runtime.contract.chunks import (
    CHUNK_BYTES_MAX,
    StoredChunk,
    decode_pictures,
    require_encoding,
    shuffled_times,
    unpack,
    unpack_rows,
)
from robot_runtime.contract.documents import Event
from robot_runtime.contract.topics import BY_NAME, Kind
from server.features.exports.archive_models import ArchivedTopic
from server.library.upgrade import MissingFieldError, rewrite_document

SPAN_MAX = 1e9
"""s, some 30 years: the longest time between a session's start and anything in it."""
EVENT_FIELDS = frozenset(field.name for field in fields(Event))


def check_chunk(chunk: StoredChunk, name: str, topic: ArchivedTopic, origin: float) -> None:
    """Check a chunk of the topic `name`; `origin` is the session's start (s, steady). Raise ValueError."""
    require_encoding(chunk.encoding, topic.kind)
    times = _read_times(chunk, name, topic)
    if len(times) != chunk.count:
        raise ValueError(f"it holds {len(times)} samples instead of {chunk.count}")
    if not all(map(isfinite, times)) or max(origin - min(times), max(times) - origin) > SPAN_MAX:
        raise ValueError("a sample's time is far from the session's")
    if (times[0], times[-1]) != (chunk.first_time, chunk.last_time):
        raise ValueError("its samples have other times than it announces")


def check_document(document: object, name: str, described: ArchivedTopic | None = None) -> None:
    """Check a document of a topic: the fields of its description, in types that this version reads.

    A document of another version may lack fields of this one's. Raise ValueError with the reason.
    """
    if not isinstance(document, Mapping):
        raise ValueError("a document is no object")
    topic = BY_NAME.get(name)
    known = topic is not None and topic.kind is Kind.DOCUMENTS
    required = {field.name for field in described.fields} if described is not None else set()
    if topic is not None and topic.record is Event:
        required |= EVENT_FIELDS
    if missing := sorted(required - document.keys()):
        raise ValueError(f"a document lacks {missing[0]}")
    if topic is not None and known:
        try:
            rewrite_document(document, topic)
        except MissingFieldError:
            return


def _read_times(chunk: StoredChunk, name: str, topic: ArchivedTopic) -> Sequence[float]:
    if topic.kind in ("picture", "film"):
        return [time for time, _ in decode_pictures(chunk.data)]
    if topic.kind == "rows":
        announced = chunk.count * topic.row_bytes
        shuffled = unpack_rows(chunk.data, topic.row_bytes, min(CHUNK_BYTES_MAX, announced))
        return shuffled_times(shuffled, topic.row_bytes)
    return [_read_time(line, name, topic) for line in unpack(chunk.data).splitlines()]


def _read_time(line: bytes, name: str, topic: ArchivedTopic) -> float:
    try:
        document = json.loads(line, parse_constant=_refuse_constant)
    except RecursionError as problem:
        raise ValueError("a document is nested too deeply") from problem
    check_document(document, name, topic)
    time: Any = document.get("time")
    if not isinstance(time, int | float) or isinstance(time, bool):
        raise ValueError("a document has no time")
    return float(time)


def _refuse_constant(name: str) -> None:
    raise ValueError(f"a document holds {name}")
