"""CSV, a table for each topic: units in the header, and numbers that read back exactly."""

import json
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import chain
from typing import Any, BinaryIO

from robot_runtime.contract.chunks import row_layout
from robot_runtime.contract.film_picture import FilmPicture
from robot_runtime.contract.topics import SNAPSHOT
from server.features.exports.description import write_about
from server.features.exports.selection import ExportSelection
from server.features.exports.zip_stream import ZipWriter
from server.library.film import NoFilmError, film_from, write_mp4
from server.library.snapshots import read_values
from server.platform.csv_cells import STYLES, CsvStyle, escape_formula
from server.platform.store import Reader


def write_tables(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write a zip file of `session.json`, a CSV file for each topic, JPEG files and the film.

    A snapshot has a file of its values beside it.

    Raise CodecMissingError, StoreError, RecordingError.
    """
    packing, style = ZipWriter(output), STYLES[source.options.spreadsheet]
    write_about(store, source, packing)
    for name in source.names:
        if source.topics[name]["kind"] == "picture":
            for time, jpeg in source.pictures(name, source.start, source.end):
                member = f"{name}/{source.since_start(time):010.3f}"
                with packing.member(f"{member}.jpg") as file:
                    file.write(jpeg)
                if name == SNAPSHOT.name:
                    packing.text(f"{member}.json", read_values(source, time).model_dump_json(indent=2) + "\n")
            continue
        if source.topics[name]["kind"] == "film":
            _write_film(source, packing, name)
            continue
        with packing.member(f"{name}.csv") as file:
            file.write(style.mark.encode())
            for lines in _lines(source, name, style):
                file.write(lines.encode())
    packing.close()


def _write_film(source: ExportSelection, packing: ZipWriter, name: str) -> None:
    pictures = source.film(source.start, source.end)
    first = next(pictures, None)
    if first is not None and FilmPicture(first[1]).is_jpeg:
        for time, jpeg in chain([first], pictures):
            with packing.member(f"{name}/{source.since_start(time):010.3f}.jpg") as file:
                file.write(jpeg)
        return
    # The range may hold no picture that can be shown.
    with suppress(NoFilmError):
        playable = film_from(source, source.start, source.end)
        with packing.member(f"{name}.mp4") as file:
            write_mp4(playable, file)


def _lines(source: ExportSelection, name: str, style: CsvStyle) -> Iterator[str]:
    topic = source.topics[name]
    if topic["kind"] == "rows":
        columns, write = _row_writer(source, topic)
        yield style.write([["time [s]", "utc", *columns]])
        for rows in source.batches(name):
            yield style.rewrite(write(rows))
    else:
        header = [field["name"] for field in topic["fields"] if field["name"] != "time"]
        yield style.write([["time [s]", "utc", *header]])
        for document in source.documents(name, source.start, source.end):
            time = document["time"]
            cells = (_cell(document.get(column), style) for column in header)
            seconds = style.number(f"{source.since_start(time):.6f}")
            yield style.write([[seconds, style.moment(source.utc(time)), *cells]])


def _row_writer(
    source: ExportSelection, topic: dict[str, Any]
) -> tuple[tuple[str, ...], Callable[[bytes], str]]:
    layout = row_layout(topic)
    line = f"%.6f,%s,{layout.line}\n"

    def write(rows: bytes) -> str:
        times, *counts = zip(*layout.row.iter_unpack(rows), strict=True)
        values = (
            column if scale == 1 else [count * scale for count in column]
            for column, scale in zip(counts, layout.scales, strict=True)
        )
        cells = zip(map(source.since_start, times), map(source.utc, times), *values, strict=True)
        return line * len(times) % tuple(chain.from_iterable(cells))

    return layout.columns, write


def _cell(value: object, style: CsvStyle) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return style.number(json.dumps(value))
    return escape_formula(value) if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
