"""Parquet: a file for each topic, with the recorded types of the numbers."""

import json
from collections.abc import Iterator
from typing import Any, BinaryIO

from server.features.exports.description import write_about
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.features.exports.values import Rows
from server.features.exports.zip_stream import ZipWriter
from server.platform.store import Reader

INTEGERS = {"b": "int8", "B": "uint8", "h": "int16", "H": "uint16", "i": "int32", "I": "uint32", "q": "int64"}
GROUP_ROWS = 50_000
"""Rows written at once, which bounds the memory."""


def check_parquet() -> None:
    """Raise ExportRequestError if the package pyarrow is missing."""
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError as problem:
        raise ExportRequestError(
            "Parquet needs the package pyarrow, which is not installed. Install it where µ-CAT is installed, "
            "with `pip install mucat[parquet]`, or choose another format."
        ) from problem


def write_parquet(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write a zip file of `session.json` and a Parquet file for each topic.

    Columns are `time` (s since the session's start), `utc` and the fields in SI units; fields of
    documents are text, lists and objects as JSON. Raise ExportRequestError, StoreError, RecordingError.
    """
    check_parquet()
    packing = ZipWriter(output, packed=False)
    write_about(store, source, packing)
    for name in source.names:
        with packing.member(f"{name}.parquet") as file:
            write_topic(source, name, file)
    packing.close()


def write_topic(source: ExportSelection, name: str, file: Any) -> None:
    """Write a Parquet file of one topic, with the columns of `write_parquet`."""
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    schema, batches = _READERS[source.topics[name]["kind"]](source, name)
    with ParquetWriter(pa.PythonFile(file, "w"), schema) as writer:
        waiting: list[Any] = []
        count = 0
        for times, columns in batches:
            moments = pa.array([source.utc_ns(time) // 1000 for time in times], pa.timestamp("us", "UTC"))
            arrays = [pa.array([source.since_start(time) for time in times]), moments]
            arrays += [
                pa.array(column, field.type) for column, field in zip(columns, list(schema)[2:], strict=True)
            ]
            waiting.append(pa.record_batch(arrays, schema=schema))
            count += len(times)
            if count >= GROUP_ROWS:
                writer.write_table(pa.Table.from_batches(waiting))
                waiting, count = [], 0
        if waiting:
            writer.write_table(pa.Table.from_batches(waiting))


def _rows(source: ExportSelection, name: str) -> tuple[Any, Iterator[tuple[Any, Any]]]:
    import pyarrow as pa

    rows = Rows(source, name)
    fields = [
        pa.field(
            column, _type(field.code, field.scale), metadata={"unit": field.unit, "meaning": field.meaning}
        )
        for field in rows.fields
        for column in field.columns
    ]
    return pa.schema(_head() + fields), rows.batches()


def _documents(source: ExportSelection, name: str) -> tuple[Any, Iterator[tuple[Any, Any]]]:
    import pyarrow as pa

    names = [field["name"] for field in source.topics[name]["fields"] if field["name"] != "time"]

    def batches() -> Iterator[tuple[Any, Any]]:
        for document in source.documents(name, source.start, source.end):
            yield [document["time"]], [[_text(document.get(name))] for name in names]

    return pa.schema(_head() + [pa.field(name, pa.string()) for name in names]), batches()


def _pictures(source: ExportSelection, name: str) -> tuple[Any, Iterator[tuple[Any, Any]]]:
    import pyarrow as pa

    pictures = source.pictures(name, source.start, source.end)
    return (
        pa.schema([*_head(), pa.field("jpeg", pa.binary())]),
        (([time], [[jpeg]]) for time, jpeg in pictures),
    )


def _film(source: ExportSelection, name: str) -> tuple[Any, Iterator[tuple[Any, Any]]]:  # noqa: ARG001
    import pyarrow as pa

    pictures = source.film(source.start, source.end)
    return (
        pa.schema([*_head(), pa.field("picture", pa.binary())]),
        (([time], [[picture]]) for time, picture in pictures),
    )


_READERS = {"rows": _rows, "documents": _documents, "picture": _pictures, "film": _film}


def _head() -> list[Any]:
    import pyarrow as pa

    return [
        pa.field("time", pa.float64(), metadata={"unit": "s", "meaning": "since the session's start"}),
        pa.field("utc", pa.timestamp("us", "UTC")),
    ]


def _type(code: str, scale: float) -> Any:
    import pyarrow as pa

    if code == "f" and scale == 1:
        return pa.float32()
    return pa.type_for_alias(INTEGERS[code]) if scale == 1 and code in INTEGERS else pa.float64()


def _text(value: object) -> str | None:
    if value is None or isinstance(value, str):
        return value
    return json.dumps(value, ensure_ascii=False)
