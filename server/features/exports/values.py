"""Samples as objects in SI units, for MCAP and Parquet.

A field named `time` becomes `board_time`, since `time` is the sample's; µs become s.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from math import isfinite
from typing import Any

from server.features.exports.selection import ExportSelection
from server.features.sessions.chunks import DIGITS, SCALED_DIGITS, row_layout

MICRO = 1e-6
NOT_FINITE = re.compile(r"(?<=[:,\[])-?(?:nan|inf)(?=[,\]}])")
"""A bare word in JSON text that is made of numbers and quoted names."""


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a topic of rows: `count` values of struct's type `code`, each to be multiplied."""

    name: str
    unit: str
    meaning: str
    code: str
    count: int
    scale: float

    @property
    def digits(self) -> str:
        """The format of a value, from which the same number is read back."""
        return DIGITS.get(self.code, "%d" if self.scale == 1 else SCALED_DIGITS)

    @property
    def columns(self) -> list[str]:
        """A name for each value."""
        return [self.name] if self.count == 1 else [f"{self.name}_{place}" for place in range(self.count)]


def fields_of(topic: dict[str, Any]) -> list[Field]:
    """The fields of a topic of rows, from its description by `describe_topics`."""
    return [
        Field(
            name="board_time" if field["name"] == "time" else field["name"],
            unit="s" if field["unit"] == "µs" else field["unit"],
            meaning=field["meaning"],
            code=field["code"],
            count=field["count"],
            scale=field["scale"] * MICRO if field["unit"] == "µs" else field["scale"],
        )
        for field in topic["fields"]
    ]


Columns = list[Sequence[Any]]


class Rows:
    """Reads a topic of rows: batches of their times (s, steady clock) and of their values by column."""

    def __init__(self, source: ExportSelection, name: str) -> None:
        topic = source.topics[name]
        self.fields = fields_of(topic)
        self._source = source
        self._name = name
        self._row = row_layout(topic).row
        self._scales = [field.scale for field in self.fields for _ in range(field.count)]
        self._floats = [field.code in DIGITS for field in self.fields for _ in range(field.count)]
        self._members = ",".join(_member(field) for field in self.fields)

    def batches(self) -> Iterator[tuple[Sequence[float], Columns]]:
        """Yield the rows in batches of some hundreds. Raises StoreError, RecordingError."""
        for rows in self._source.batches(self._name):
            times, *counts = zip(*self._row.iter_unpack(rows), strict=True)
            yield (
                times,
                [
                    column if scale == 1 else [count * scale for count in column]
                    for column, scale in zip(counts, self._scales, strict=True)
                ],
            )

    def lines(self, head: str, heads: list[Sequence[Any]], columns: Columns) -> list[bytes]:
        """A JSON object for each row, in UTF-8: `head` is formatted with `heads`, and then come the fields.

        NaN and infinity, which JSON lacks, are null.
        """
        line = f"{{{head},{self._members}}}\n"
        cells = chain.from_iterable(zip(*heads, *columns, strict=True))
        text = line * len(columns[0]) % tuple(cells)
        if not all(
            all(map(isfinite, column)) for column, wide in zip(columns, self._floats, strict=True) if wide
        ):
            text = NOT_FINITE.sub("null", text)
        return text.encode().splitlines()


def _member(field: Field) -> str:
    values = ",".join([field.digits] * field.count)
    return f'"{field.name}":[{values}]' if field.count > 1 else f'"{field.name}":{values}'
