"""Reads signals, with a cache for those of complete sessions."""

from collections import OrderedDict
from collections.abc import Iterable
from threading import Lock
from typing import Any

import numpy as np

from server.features.comparison.signals import DOCUMENT_COLUMNS, split
from server.features.metrics.series import Floats, Series
from server.features.sessions.recording import Recording

CACHE_BYTES = 32_000_000


class Samples:
    """The signals of sessions; may be asked from several threads."""

    def __init__(self) -> None:
        self._cache: OrderedDict[tuple[str, str], Series] = OrderedDict()
        self._bytes = 0
        self._lock = Lock()

    def read(self, recording: Recording, names: Iterable[str]) -> dict[str, Series]:
        """These signals, as far as the session has them.

        Raises ValueError on what is no signal's name, StoreError, RecordingError.
        """
        chosen = {name: split(name) for name in names}
        found = {name: series for name in chosen if (series := self._recall(recording, name))}
        missing: dict[str, list[str]] = {}
        for name, (topic, column) in chosen.items():
            if name not in found:
                missing.setdefault(topic, []).append(column)
        for topic, columns in missing.items():
            for column, series in read_topic(recording, topic, columns).items():
                found[f"{topic}.{column}"] = series
                self._keep(recording, f"{topic}.{column}", series)
        return found

    def _recall(self, recording: Recording, name: str) -> Series | None:
        key = recording.row.identifier, name
        with self._lock:
            if key in self._cache:
                self._cache.move_to_end(key)
            return self._cache.get(key)

    def _keep(self, recording: Recording, name: str, series: Series) -> None:
        if recording.row.state == "recording" or series.bytes > CACHE_BYTES:
            return
        with self._lock:
            self._bytes += series.bytes
            replaced = self._cache.pop((recording.row.identifier, name), None)
            self._bytes -= replaced.bytes if replaced else 0
            self._cache[recording.row.identifier, name] = series
            while self._bytes > CACHE_BYTES:
                _, oldest = self._cache.popitem(last=False)
                self._bytes -= oldest.bytes


def read_topic(recording: Recording, topic: str, columns: Iterable[str]) -> dict[str, Series]:
    """These columns of a topic, as far as the session has them. Raises StoreError, RecordingError."""
    described = recording.topics.get(topic)
    if described is None:
        return {}
    if described["kind"] == "rows":
        return _read_rows(recording, topic, _columns_there(described, columns))
    return _read_documents(recording, topic, columns)


def _columns_there(described: dict[str, Any], columns: Iterable[str]) -> list[str]:
    there = {
        f"{field['name']}_{place}" if field["count"] > 1 else field["name"]
        for field in described["fields"]
        for place in range(field["count"])
    }
    return [column for column in columns if column in there]


def _read_rows(recording: Recording, topic: str, columns: list[str]) -> dict[str, Series]:
    if not columns:
        return {}
    times, values = recording.columns(topic, columns)
    return {column: _ordered(recording, times, values[column]) for column in columns if times.size}


def _read_documents(recording: Recording, topic: str, columns: Iterable[str]) -> dict[str, Series]:
    known = DOCUMENT_COLUMNS.get(topic, {})
    chosen = {column: known[column].read for column in columns if column in known}
    if not chosen:
        return {}
    times: list[float] = []
    values: dict[str, list[float]] = {column: [] for column in chosen}
    for document in recording.documents(topic):
        try:
            row = {column: read(document) for column, read in chosen.items()}
        except (KeyError, TypeError, ValueError):
            continue  # of a version that had no such number
        times.append(document["time"])
        for column, value in row.items():
            values[column].append(value)
    return {
        column: _ordered(recording, np.array(times), np.array(values[column])) for column in chosen if times
    }


def _ordered(recording: Recording, times: Floats, values: Floats) -> Series:
    """Samples in order of time; those refetched after a gap may be stored behind newer ones."""
    since = times - recording.row.started_steady
    if np.all(since[1:] >= since[:-1]):
        return Series(since, values)
    order = np.argsort(since, kind="stable")
    return Series(since[order], values[order])
