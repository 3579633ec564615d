"""Reads signals, with a cache for those of complete sessions."""

from collections.abc import Iterable

import numpy as np

from robot_runtime.contract.chunks import row_layout
from server.analysis.result_cache import ResultCache
from server.analysis.signals import DOCUMENT_COLUMNS, split
from server.library.content import Recording
from server.metrics.series import Floats, Series

CACHE_BYTES = 32_000_000


class Samples:
    """The signals of sessions, cached; several threads may read them."""

    def __init__(self) -> None:
        self._cache: ResultCache[Series] = ResultCache(CACHE_BYTES, lambda series: series.bytes)

    def read(self, recording: Recording, names: Iterable[str]) -> dict[str, Series]:
        """Return the signals of these names that the session has.

        Raise ValueError for an invalid name, StoreError, RecordingError.
        """
        chosen = {name: split(name) for name in names}
        row = recording.row
        cached = {name: series for name in chosen if (series := self._cache.get(row, name))}
        missing: dict[str, list[str]] = {}
        for name, (topic, column) in chosen.items():
            if name not in cached:
                missing.setdefault(topic, []).append(column)
        for topic, columns in missing.items():
            for column, series in read_topic(recording, topic, columns).items():
                cached[f"{topic}.{column}"] = series
                self._cache.put(row, f"{topic}.{column}", series)
        return cached


def read_topic(recording: Recording, topic: str, columns: Iterable[str]) -> dict[str, Series]:
    """Return the columns of these names that the topic has. Raise StoreError, RecordingError."""
    described = recording.topics.get(topic)
    if described is None:
        return {}
    if described["kind"] == "rows":
        there = row_layout(described).names
        return _read_rows(recording, topic, [column for column in columns if column in there])
    return _read_documents(recording, topic, columns)


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
            continue  # of a version without this number
        times.append(document["time"])
        for column, value in row.items():
            values[column].append(value)
    return {
        column: _ordered(recording, np.array(times), np.array(values[column])) for column in chosen if times
    }


def _ordered(recording: Recording, times: Floats, values: Floats) -> Series:
    """Return the samples in order of time; those fetched after a gap may be stored behind newer ones."""
    since = times - recording.row.started_steady
    if np.all(since[1:] >= since[:-1]):
        return Series(since, values)
    order = np.argsort(since, kind="stable")
    return Series(since[order], values[order])
