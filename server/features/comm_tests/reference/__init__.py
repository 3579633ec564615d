"""The thesis's own results: Table 5 (plain numbers) and Table 6 (packets), as printed.

Table 5 calls its delays milliseconds but prints seconds, and prints the same delay in its last three rows;
they are taken in the order of the others: 0, 0.5 and 1 s. It has no Arduino delay: 0.
"""

import csv
from collections.abc import Iterator
from importlib.resources import files
from typing import Literal, get_args

GridPlace = tuple[int, float, float]
"""Baud (bit/s), Arduino delay (s), Pi delay (s)."""
TableName = Literal["table5", "table6"]
TABLES: tuple[TableName, ...] = get_args(TableName)
TITLES = {"table5": "Thesis, Table 5: plain numbers", "table6": "Thesis, Table 6: packets"}
TABLE5_DELAYS = (0.0, 0.5, 1.0)


def read_table(name: str) -> dict[GridPlace, float]:
    """Return the success rates of one of TABLES, 0 to 1."""
    return dict(_table5() if name == "table5" else _table6())


def _table5() -> Iterator[tuple[GridPlace, float]]:
    for number, row in enumerate(_rows("table5")):
        delay = TABLE5_DELAYS[number % len(TABLE5_DELAYS)]
        yield (int(row["baud"]), 0.0, delay), float(row["success_rate"])


def _table6() -> Iterator[tuple[GridPlace, float]]:
    for row in _rows("table6"):
        cell = (int(row["baud"]), float(row["arduino_delay_s"]), int(row["pi_delay_ms"]) / 1000)
        yield cell, float(row["success_rate"])


def _rows(name: str) -> Iterator[dict[str, str]]:
    text = (files(__name__) / f"{name}.csv").read_text(encoding="utf-8")
    return csv.DictReader(text.splitlines())
