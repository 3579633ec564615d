"""CSV for programs and for spreadsheets, which calculate texts and read numbers by the country's habits."""

import csv
import io
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

Spreadsheet = Literal["none", "point", "comma"]
"""The reader of a file: programs, or a spreadsheet with this decimal sign."""
FORMULA = ("=", "+", "-", "@", "\t", "\n", "＝", "＋", "－", "＠")
"""Beginnings of what spreadsheets calculate."""
_NOT_FINITE = re.compile(r"(?<![^,\n])-?(?:nan|inf)(?![^,\n])")


def escape_formula(text: str) -> str:
    """Return a text behind an apostrophe where a spreadsheet would take it for a formula.

    A text that has an apostrophe there gets another one, so that it can be read back.
    """
    # Python's writer does not quote a carriage return, after which a spreadsheet begins a new cell.
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    return f"'{text}" if text.lstrip("'").startswith(FORMULA) else text


@dataclass(frozen=True, slots=True)
class CsvStyle:
    """A style of CSV. `mark` begins a file: it tells a spreadsheet that the text is UTF-8."""

    mark: str = ""
    separator: str = ","
    decimal: str = "."

    def write(self, lines: Iterable[Iterable[object]]) -> str:
        """Return lines of cells as CSV."""
        text = io.StringIO()
        writer = csv.writer(text, delimiter=self.separator, lineterminator="\n")
        writer.writerows([self._cell(cell) for cell in line] for line in lines)
        return text.getvalue()

    def rewrite(self, lines: str) -> str:
        """Return lines of numbers and times that were written for programs, in this style.

        For a spreadsheet a time has no letters, and a value that is no number is an empty cell.
        """
        if not self.mark:
            return lines
        table = str.maketrans({",": self.separator, ".": self.decimal, "T": " ", "Z": None})
        return _NOT_FINITE.sub("", lines).translate(table)

    def moment(self, utc: str) -> str:
        """Return a time in ISO 8601."""
        return self.rewrite(utc)

    def number(self, digits: str) -> str:
        """Return a number that was written for programs."""
        return digits.replace(".", self.decimal)

    def _cell(self, value: object) -> object:
        return self.number(repr(value)) if isinstance(value, float) else value


STYLES: Mapping[Spreadsheet, CsvStyle] = {
    "none": CsvStyle(),
    "point": CsvStyle("\ufeff"),
    "comma": CsvStyle("\ufeff", ";", ","),
}
