"""JSON Lines: one object a sample, all topics together in the order of time."""

import base64
import heapq
import json
from collections.abc import Iterator, Sequence
from itertools import repeat
from typing import Any, BinaryIO

from server.features.exports.selection import ExportSelection
from server.features.exports.values import Rows
from server.platform.store import Reader


def write_lines(_store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write an object per sample: `topic`, `time` (s since the session's start), `utc` and its fields.

    The field of a picture is `jpeg`, in Base64. Raises StoreError, RecordingError.
    """
    topics = [_lines(source, name, place) for place, name in enumerate(source.names)]
    for _time, _place, line in heapq.merge(*topics):
        output.write(line + b"\n")


def _lines(source: ExportSelection, name: str, place: int) -> Iterator[tuple[float, int, bytes]]:
    kind = source.topics[name]["kind"]
    if kind == "rows":
        rows = Rows(source, name)
        head = f'"topic":"{name}","time":%.6f,"utc":"%s"'
        for times, columns in rows.batches():
            heads: list[Sequence[Any]] = [
                [source.since_start(time) for time in times],
                [source.utc(time) for time in times],
            ]
            yield from zip(times, repeat(place), rows.lines(head, heads, columns))
    elif kind == "documents":
        for document in source.documents(name, source.start, source.end):
            time = document["time"]
            common = {"topic": name, "time": round(source.since_start(time), 6), "utc": source.utc(time)}
            line = json.dumps({**document, **common}, ensure_ascii=False, separators=(",", ":"))
            yield time, place, line.encode()
    else:
        for time, jpeg in source.pictures(name, source.start, source.end):
            common = {"topic": name, "time": round(source.since_start(time), 6), "utc": source.utc(time)}
            yield time, place, json.dumps({**common, "jpeg": base64.b64encode(jpeg).decode()}).encode()
