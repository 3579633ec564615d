"""XLSX: a workbook with a sheet for each topic, real numbers and dates."""

import json
from collections.abc import Iterable, Iterator
from math import isfinite
from typing import TYPE_CHECKING, Any, BinaryIO

from robot_runtime.contract.chunks import row_layout
from server.features.exports.description import describe_session
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.features.exports.zip_stream import ForwardOnly
from server.platform.store import Reader

if TYPE_CHECKING:
    from xlsxwriter import Workbook
    from xlsxwriter.worksheet import Worksheet

SHEET_LINES = 1_048_576
"""Lines of a sheet in Excel and LibreOffice, the header among them."""
SHEET_NAME_MAX = 31
CELL_CHARACTERS = 32_767
CUT = " … (cut: a cell holds no more)"
ABOUT = "session"
SECONDS_OF_DAY = 86_400
EPOCH = 25_569
"""1970-01-01 in days, as a spreadsheet counts them."""


def require_sheets(source: ExportSelection) -> None:
    """Raise ExportRequestError where a topic may have more samples than a sheet has lines."""
    large = [f"{name} has {count}" for name, count in source.samples.items() if count >= SHEET_LINES]
    if large:
        raise ExportRequestError(
            f"A sheet holds {SHEET_LINES - 1} samples, and {', '.join(large)} in this range. Choose a "
            "shorter range, fewer topics, or csv-grid with a longer period."
        )


def write_workbook(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write a workbook: the session's description, and a sheet for each topic but pictures and film.

    Raise ExportRequestError for a topic that no sheet holds, StoreError, RecordingError.
    """
    from xlsxwriter import Workbook
    from xlsxwriter.exceptions import FileCreateError

    require_sheets(source)
    book = Workbook(ForwardOnly(output), {"constant_memory": True, "use_zip64": True})
    names = [name for name in source.names if source.topics[name]["kind"] in ("rows", "documents")]
    _Sheet(book, ABOUT, ["", ""]).extend(_describe(store, source))
    for name, title in zip(names, _sheet_names(names), strict=True):
        if source.topics[name]["kind"] == "rows":
            _Sheet(book, title, _header(source, name)).extend(_rows(source, name))
        else:
            _Sheet(book, title, _header(source, name)).extend(_documents(source, name))
    book.set_properties({"title": source.row.name, "created": source.date(source.row.started_steady)})
    try:
        book.close()
    except FileCreateError as problem:
        raise problem.args[0] from problem


class _Sheet:
    """A sheet that is written line by line. Its first line stays in sight."""

    def __init__(self, book: "Workbook", name: str, header: list[str]) -> None:
        self._sheet: Worksheet = book.add_worksheet(name)
        self._date = book.add_format({"num_format": "yyyy-mm-dd hh:mm:ss.000"})
        bold = book.add_format({"bold": True})
        self._sheet.freeze_panes(1, 0)
        for column, title in enumerate(header):
            self._sheet.set_column(column, column, max(12, len(title) + 2))
            self._sheet.write_string(0, column, title, bold)
        if header[1] == "utc":
            self._sheet.set_column(1, 1, 24, self._date)
        self._line = 0

    def extend(self, lines: Iterable[Iterable[object]]) -> None:
        """Add lines. Empty cells stand for null and NaN."""
        sheet = self._sheet
        for line in lines:
            self._line += 1
            for column, value in enumerate(line):
                if isinstance(value, bool):
                    sheet.write_boolean(self._line, column, value)
                elif isinstance(value, int | float):
                    if isfinite(value):
                        sheet.write_number(self._line, column, value)
                elif value is not None:
                    # As a string it is no formula, whatever it begins with.
                    sheet.write_string(self._line, column, _cell_text(value))


def _header(source: ExportSelection, name: str) -> list[str]:
    topic = source.topics[name]
    if topic["kind"] == "rows":
        return ["time [s]", "utc", *row_layout(topic).columns]
    return ["time [s]", "utc", *(field["name"] for field in topic["fields"] if field["name"] != "time")]


def _rows(source: ExportSelection, name: str) -> Iterator[Iterable[object]]:
    layout = row_layout(source.topics[name])
    for rows in source.batches(name):
        for time, *counts in layout.row.iter_unpack(rows):
            yield (
                *_moment(source, time),
                *(
                    count if scale == 1 else count * scale
                    for count, scale in zip(counts, layout.scales, strict=True)
                ),
            )


def _documents(source: ExportSelection, name: str) -> Iterator[Iterable[object]]:
    fields = [field["name"] for field in source.topics[name]["fields"] if field["name"] != "time"]
    for document in source.documents(name, source.start, source.end):
        yield (*_moment(source, document["time"]), *(document.get(field) for field in fields))


def _moment(source: ExportSelection, time: float) -> tuple[float, float]:
    """Return the s since the session's start, and the date in a spreadsheet's days."""
    since = source.since_start(time)
    return round(since, 6), (source.row.started + since) / SECONDS_OF_DAY + EPOCH


def _describe(store: Reader, source: ExportSelection) -> Iterator[Iterable[object]]:
    described: dict[str, Any] = describe_session(store, source)
    for name in ("name", "robot", "started", "ended", "duration", "note", "tags", "version", "identifier"):
        value = described[name]
        yield name, ", ".join(value) if isinstance(value, list) else value
    for mark in described["marks"]:
        yield f"bookmark at {mark['time']:.3f} s", mark["text"]


def _sheet_names(topics: list[str]) -> list[str]:
    """Return a name for each sheet, of the length that a spreadsheet takes."""
    names: list[str] = [ABOUT]
    for topic in topics:
        name = topic[:SHEET_NAME_MAX]
        if name in names:
            name = f"{name[: SHEET_NAME_MAX - 4]}~{len(names)}"
        names.append(name)
    return names[1:]


def _cell_text(value: object) -> str:
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= CELL_CHARACTERS else text[: CELL_CHARACTERS - len(CUT)] + CUT
