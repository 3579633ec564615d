"""Samples as objects in SI units, for MCAP and Parquet."""

import re
from collections.abc import Iterator, Sequence
from itertools import chain
from math import isfinite
from typing import Any

from robot_runtime.contract.chunks import DIGITS, RowField, row_layout, si_fields
from server.features.exports.selection import ExportSelection

NOT_FINITE = re.compile(r"(?<=[:,\[])-?(?:nan|inf)(?=[,\]}])")
"""A bare word in JSON text that is made of numbers and quoted names."""


Columns = list[Sequence[Any]]


class Rows:
    """A topic of rows, read in batches of times (s, steady clock) and of values by column."""

    def __init__(self, source: ExportSelection, name: str) -> None:
        topic = source.topics[name]
        self.fields = si_fields(topic)
        self._source = source
        self._name = name
        self._row = row_layout(topic).row
        self._scales = [field.scale for field in self.fields for _ in range(field.count)]
        self._floats = [field.code in DIGITS for field in self.fields for _ in range(field.count)]
        self._members = ",".join(_member(field) for field in self.fields)

    def batches(self) -> Iterator[tuple[Sequence[float], Columns]]:
        """Yield the rows in batches of some hundreds. Raise StoreError, RecordingError."""
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
        """Return a JSON object for each row, in UTF-8: `head`, formatted with `heads`, then the fields.

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


def _member(field: RowField) -> str:
    values = ",".join([field.digits] * field.count)
    return f'"{field.name}":[{values}]' if field.count > 1 else f'"{field.name}":{values}'
