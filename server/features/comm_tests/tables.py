"""Runs as text, CSV and JSON."""

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from server.features.comm_tests.reference import GridPlace
from server.platform.csv_cells import CsvStyle, escape_formula
from server.platform.models import CommTestCell, CommTestRun

COLUMNS = [name for name in CommTestCell.model_fields if name not in ("id", "run_id")]


def places(cells: Sequence[CommTestCell]) -> dict[GridPlace, float]:
    """Return the rates of cells by their position in the grid."""
    return {(cell.baud, cell.arduino_delay, cell.pi_delay): cell.rate for cell in cells}


def show_cells(cells: Sequence[CommTestCell]) -> str:
    """Return a table as in the thesis's Figure 18, with the causes of errors."""
    rows = [
        [*_delays((cell.baud, cell.arduino_delay, cell.pi_delay)), f"{cell.rate:.2f}", cell.causes]
        for cell in cells
    ]
    return _table(["baud", "Arduino delay (s)", "Pi delay (s)", "rate", "what went wrong"], rows)


def show_run(run: CommTestRun, cells: Sequence[CommTestCell]) -> str:
    """Return a run with its configuration, its table and the explanations of errors."""
    facts = {
        "run": f"{run.id}, {run.name}",
        "state": run.state + (f": {run.problem}" if run.problem else ""),
        "started": _moment(run.started),
        "ended": "-" if run.ended is None else _moment(run.ended),
        "framing": run.framing,
        "direction": run.direction,
        "document": run.document,
        "firmware": run.firmware,
        "tools": ", ".join(f"{name} {text}" for name, text in json.loads(run.tools).items()),
        "host": run.host,
        "place": run.place,
        "test's time": f"{sum(cell.seconds for cell in cells):.0f} s",
    }
    lines = [f"{name:<14}{text}" for name, text in facts.items()]
    reasons = [
        f"{cell.baud} baud, Arduino {cell.arduino_delay:g} s, Pi {cell.pi_delay:g} s: "
        + "; ".join(cell.explanation.splitlines())
        for cell in cells
        if cell.causes
    ]
    return "\n".join([*lines, "", show_cells(cells), *(["", *reasons] if reasons else [])])


def show_list(runs: Sequence[CommTestRun]) -> str:
    """Return one line for each run."""
    rows = [
        [str(run.id), _moment(run.started), run.state, run.framing, run.direction, str(run.cells), run.name]
        for run in runs
    ]
    return _table(["id", "started", "state", "framing", "direction", "cells", "name"], rows)


def show_comparison(columns: Mapping[str, Mapping[GridPlace, float]]) -> str:
    """Return the rates of the first column's cells, and those of the other columns with the differences."""
    first, *others = columns
    header = ["baud", "Arduino delay (s)", "Pi delay (s)", first]
    for name in others:
        header += [name, "difference"]
    rows = []
    for cell in columns[first]:
        base = columns[first][cell]
        row = [*_delays(cell), f"{base:.2f}"]
        for name in others:
            rate = columns[name].get(cell)
            row += ["-", "-"] if rate is None else [f"{rate:.2f}", f"{rate - base:+.2f}"]
        rows.append(row)
    return _table(header, rows)


def write_csv(run: CommTestRun, cells: Sequence[CommTestCell], style: CsvStyle) -> str:
    """Return a line for each cell, with the run's number, framing and direction; delay and seconds in s."""
    lines: list[Sequence[object]] = [["run", "framing", "direction", *COLUMNS]]
    for cell in cells:
        values = (getattr(cell, name) for name in COLUMNS)
        lines.append([run.id, run.framing, run.direction, *(_csv_value(value) for value in values)])
    return style.mark + style.write(lines)


def _csv_value(value: object) -> object:
    return escape_formula(value) if isinstance(value, str) else value


def write_json(run: CommTestRun, cells: Sequence[CommTestCell]) -> str:
    """Return the run with its configuration and its cells."""
    whole: dict[str, Any] = run.model_dump()
    whole["document"] = json.loads(run.document)
    whole["tools"] = json.loads(run.tools)
    whole["cells"] = [{name: getattr(cell, name) for name in COLUMNS} for cell in cells]
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def _delays(cell: GridPlace) -> list[str]:
    baud, arduino_delay, pi_delay = cell
    return [str(baud), f"{arduino_delay:g}", f"{pi_delay:g}"]


def _moment(seconds: float) -> str:
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M:%S} UTC"


def _table(header: list[str], rows: Sequence[list[str]]) -> str:
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    return "\n".join(
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in [header, *rows]
    )
