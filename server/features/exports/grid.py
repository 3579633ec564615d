"""One table of columns of several topics on a common grid of times."""

import statistics
from itertools import pairwise
from math import floor
from typing import TYPE_CHECKING, Any, BinaryIO

from robot_runtime.contract.chunks import row_layout
from server.features.exports.description import write_about
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.features.exports.zip_stream import ZipWriter
from server.platform.csv_cells import STYLES
from server.platform.store import Reader

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

WINDOW_LINES = 20_000
"""Lines made at once, which bounds the memory."""
LINES_MAX = 10_000_000
GAPS = 2.0
"""Largest age of a value, in usual intervals of its topic."""

README = """grid.csv: {name}
One line every {period:g} s, from {first:g} s to {last:g} s after the session's start.
`time [s]` counts from the session's start; `utc` is the same moment by the clock of the recording computer.
A column `time [µs]` is the board's own clock: it begins anew after 71.6 minutes, and when the board starts.
A cell holds the newest value at that moment. It is empty where that value is older than {gaps:g} times the
usual time between two samples of its topic:
{limits}
session.json holds everything else about the session.
"""


def write_grid(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write a zip file of `grid.csv`, `README.txt` and `session.json`.

    Raise ExportRequestError for missing columns or too many lines, StoreError, RecordingError.
    """
    chosen = _choose(source)
    period = source.options.period
    first, last = _range(source)
    count = floor((last - first) / period + 1e-9) + 1
    if count > LINES_MAX:
        raise ExportRequestError(
            f"This would be {count} lines; the most are {LINES_MAX}. Choose a longer period or shorter range."
        )
    limits = {topic: GAPS * _usual_gap(source, topic) for topic in chosen}
    packing = ZipWriter(output)
    document = "\n".join(f"  {topic}: {limit:.4g} s" for topic, limit in limits.items())
    readme = README.format(
        name=source.row.name, period=period, first=first, last=last, gaps=GAPS, limits=document
    )
    packing.text("README.txt", readme)
    write_about(store, source, packing)
    style = STYLES[source.options.spreadsheet]
    with packing.member("grid.csv") as file:
        titles = [title for columns in chosen.values() for title in columns.values()]
        file.write((style.mark + style.write([["time [s]", "utc", *titles]])).encode())
        for line in range(0, count, WINDOW_LINES):
            here = range(line, min(count, line + WINDOW_LINES))
            lines = _window(source, chosen, limits, [first + step * period for step in here])
            file.write(style.rewrite(lines).encode())
            source.report(here.stop / count)
    packing.close()


def _choose(source: ExportSelection) -> dict[str, dict[str, str]]:
    """Return, by topic in the chosen order, the columns' names and titles, such as "depth.depth [m]"."""
    there = {
        name: {plain: f"{name}.{column}" for plain, column in zip(layout.names, layout.columns, strict=True)}
        for name, topic in source.topics.items()
        if topic["kind"] == "rows" and name in source.names and (layout := row_layout(topic))
    }
    if source.options.columns is None:
        if not there:
            raise ExportRequestError("No topic has numbers in this range; there is no table to make.")
        return there
    chosen: dict[str, dict[str, str]] = {}
    for name in source.options.columns:
        topic, _, column = name.partition(".")
        if topic in source.topics and topic not in there:
            raise ExportRequestError(f"{topic} has no numbers in this range; leave {name} out.")
        if column not in there.get(topic, {}):
            known = ", ".join(f"{topic}.{column}" for column in there.get(topic, {})) or ", ".join(there)
            raise ExportRequestError(f"There is no column {name}; there are {known}.")
        chosen.setdefault(topic, {})[column] = there[topic][column]
    return chosen


def _range(source: ExportSelection) -> tuple[float, float]:
    """Return the first and the last moment, in s since the start."""
    options = source.options
    first = 0.0 if options.start is None else options.start
    last = source.row.duration if options.end is None else options.end
    if last < first:
        raise ExportRequestError("The range lies outside of the session. Choose another.")
    return first, last


def _usual_gap(source: ExportSelection, topic: str) -> float:
    """Return the time (s) between two samples: the median over the chunks."""
    spans = source.spans(topic)
    within = [(last - first) / (count - 1) for first, last, count in spans if count > 1]
    between = [later[0] - earlier[1] for earlier, later in pairwise(spans)]
    gaps = within or between
    return statistics.median(gaps) if gaps else source.options.period


def _window(
    source: ExportSelection, chosen: dict[str, dict[str, str]], limits: dict[str, float], times: list[float]
) -> str:
    import numpy as np  # only for exports: it costs a small computer memory

    grid = np.array(times) + source.row.started_steady
    parts: list[list[str]] = []
    for topic, titles in chosen.items():
        limit = limits[topic]
        seen, columns = source.columns(topic, list(titles), grid[0] - limit, grid[-1])
        newest = np.searchsorted(seen, grid, side="right") - 1
        fresh = newest >= 0
        fresh[fresh] = grid[fresh] - seen[newest[fresh]] <= limit
        digits = _digits(source.topics[topic])
        parts += [_cells(columns[column][newest[fresh]], fresh, digits[column]) for column in titles]
    utc = map(source.utc, grid.tolist())
    lines = zip((f"{time:.6f}" for time in times), utc, *parts, strict=True)
    return "".join(",".join(line) + "\n" for line in lines)


def _cells(values: "Floats", fresh: "NDArray[np.bool_]", digits: str) -> list[str]:
    numbers = iter(values.tolist())
    return [digits % next(numbers) if there else "" for there in fresh.tolist()]


def _digits(topic: dict[str, Any]) -> dict[str, str]:
    layout = row_layout(topic)
    return dict(zip(layout.names, layout.line.split(","), strict=True))
