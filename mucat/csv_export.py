"""Reads the exports of `mucat export --format csv` and the server: a zip file with a table for each topic."""

import csv
import io
import json
import re
import zipfile
from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

from mucat.errors import RobotError
from mucat.tables import SessionTables, TopicTable, si_column, typed_column
from robot_runtime.zip_members import find_members

ESCAPED = re.compile(r"'+[=+\-@\t\n＝＋－＠]")
"""The beginning of a text behind an apostrophe, without which a spreadsheet would calculate it."""
HEADED = re.compile(r"(?P<name>.*?)(?: \[(?P<unit>.*)\])?")
"""The head of a column: its name, and its unit."""


def read_csv_export(source: Path | bytes) -> SessionTables:
    """Return the tables of a file, or of its bytes. Raise BadZipFile, KeyError, ValueError, OSError."""
    with _open(source) as files:
        members = find_members(files, "session.json")
        about = json.loads(files.read(members["session.json"]))
        readers: dict[str, Callable[[], TopicTable]] = {
            name.removesuffix(".csv"): partial(_read_member, source, name)
            for name in members
            if name.endswith(".csv") and "/" not in name
        }
    return SessionTables(about, readers)


def _open(source: Path | bytes) -> zipfile.ZipFile:
    return zipfile.ZipFile(io.BytesIO(source) if isinstance(source, bytes) else source)


def _read_member(source: Path | bytes, name: str) -> TopicTable:
    try:
        with _open(source) as files, files.open(find_members(files, "session.json")[name]) as opened:
            text = io.TextIOWrapper(opened, "utf-8-sig", newline="")
            head = text.readline()
            comma = head.startswith("time [s];")
            rows = csv.reader(chain([head], text), delimiter=";" if comma else ",")
            heads = next(rows, [])
            values = [*zip(*rows, strict=True)] or [() for _ in heads]
    except (zipfile.BadZipFile, ValueError, OSError, csv.Error) as problem:
        raise RobotError(f"{name} cannot be read: {problem}.") from problem
    columns, units = {}, {}
    for head, cells in zip(heads, values, strict=True):
        match = HEADED.fullmatch(head)
        assert match is not None
        read = _read_moments(cells) if head == "utc" else _read_cells(cells, comma)
        name, unit, column = si_column(match["name"], match["unit"] or "", read)
        columns[name] = column
        if unit:
            units[name] = unit
    return TopicTable(columns, units)


def _read_moments(cells: Sequence[str]) -> Sequence[str]:
    """Return times in ISO 8601; for a spreadsheet they are written without letters."""
    return [cell if cell.endswith("Z") else cell.replace(" ", "T").replace(",", ".") + "Z" for cell in cells]


def _read_cells(cells: Sequence[str], comma: bool) -> Sequence[Any]:
    if comma:
        numbers = typed_column([cell.replace(",", ".") for cell in cells])
        if numbers and not isinstance(numbers[0], str):
            return numbers
    return typed_column([cell[1:] if ESCAPED.match(cell) else cell for cell in cells])
