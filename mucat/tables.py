"""A session's topics as tables: columns by name, and their units."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

from mucat.errors import RobotError
from mucat.packages import load_package

MICROSECOND = 1e-6


class TopicTable(NamedTuple):
    """Columns of equal length by their names, and the units of those that have one."""

    columns: Mapping[str, Sequence[Any]]
    units: Mapping[str, str]


class SessionTables:
    """The topics of one session. `about` describes it: identifier, name, robot, version and more.

    A topic is read when it is first asked for.
    """

    def __init__(self, about: Mapping[str, Any], readers: Mapping[str, Callable[[], TopicTable]]) -> None:
        self.about = about
        self._readers = {name: cache(read) for name, read in readers.items()}

    @property
    def topics(self) -> list[str]:
        """The topics of the session."""
        return [*self._readers]

    def units(self, topic: str) -> dict[str, str]:
        """Return the units of a topic's columns; those without one are left out. Raise RobotError."""
        return dict(self._table(topic).units)

    def columns(self, topic: str) -> dict[str, Sequence[Any]]:
        """Return a topic's columns by name, each a sequence of numbers or texts. Raise RobotError."""
        return dict(self._table(topic).columns)

    def pandas(self, topic: str) -> Any:
        """Return a topic as a pandas DataFrame, with the units in its `attrs`. Raise RobotError."""
        pandas = load_package("pandas")
        table = self._table(topic)
        frame = pandas.DataFrame(table.columns)
        frame.attrs["units"] = dict(table.units)
        return frame

    def polars(self, topic: str) -> Any:
        """Return a topic as a polars DataFrame; `units` returns the units. Raise RobotError."""
        return load_package("polars").DataFrame(dict(self._table(topic).columns))

    def _table(self, topic: str) -> TopicTable:
        if topic not in self._readers:
            raise RobotError(f"The session has no topic {topic}; it has {', '.join(self._readers)}.")
        return self._readers[topic]()


def si_column(name: str, unit: str, values: Sequence[Any]) -> tuple[str, str, Sequence[Any]]:
    """Return name, unit and values of a column in SI units: the board's clock, µs, is `board_time` in s."""
    if unit != "µs":
        return name, unit, values
    return "board_time" if name == "time" else name, "s", [value * MICROSECOND for value in values]


def text_of_value(value: object) -> str:
    """Return a value of a document as the text of a cell: lists and objects as JSON, nothing for null."""
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def typed_column(cells: Sequence[str]) -> Sequence[Any]:
    """Return numbers where each non-empty cell is a number, NaN for empty cells; else the texts."""
    try:
        numbers = [float(cell) if cell else math.nan for cell in cells]
    except ValueError:
        return cells
    return numbers if any(cells) else cells
