"""Runs a notebook as Jupyter would, cell after cell, and writes it as a page of the help.

Cells are plain Python, so that no kernel is needed: an expression at the end of a cell is shown, and so is
what was printed and each figure.
"""

import ast
import io
import json
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import matplotlib
import pandas

FOLDER = Path(__file__).parents[2] / "docs" / "use" / "notebooks"
NAMES = ("dive", "tune", "crafts", "sweep", "learn")
SVG: dict[Any, Any] = {
    "svg.hashsalt": "mucat",
    "svg.fonttype": "path",
    "path.simplify_threshold": 0.5,
    "figure.facecolor": "white",
}


@dataclass(slots=True)
class RunCell:
    """A cell, the text that it showed, and its figures as SVG."""

    kind: str
    source: str
    text: str = ""
    figures: list[str] = field(default_factory=list)


def read_cells(name: str) -> list[RunCell]:
    """Return the cells of a notebook."""
    document = json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))
    return [RunCell(cell["cell_type"], "".join(cell["source"])) for cell in document["cells"]]


def run(name: str) -> list[RunCell]:
    """Run a notebook; what a cell raises ends it."""
    matplotlib.use("svg")
    pandas.set_option("display.width", 110, "display.max_columns", None)
    cells, names = read_cells(name), {"__name__": "__main__"}
    with matplotlib.rc_context(SVG):
        for cell in cells:
            if cell.kind == "code":
                _run_cell(cell, names)
    return cells


def page_of(name: str, cells: list[RunCell]) -> tuple[str, dict[str, str]]:
    """Return the Markdown page of a notebook that was run, and its figures by the names of their files."""
    figures: dict[str, str] = {}
    parts = [*_parts(name, cells, figures)]
    mark = f"<!-- Written by `make notebooks` from {name}.ipynb. Do not edit. -->\n"
    note = f"[This page as a notebook]({name}.ipynb). Outputs are of a run in simulated water.\n"
    return "\n".join([parts[0], mark, note, *parts[1:]]), figures


def _parts(name: str, cells: list[RunCell], figures: dict[str, str]) -> Iterator[str]:
    for cell in cells:
        if cell.kind == "markdown":
            yield f"{cell.source}\n"
            continue
        yield f"```py\n{cell.source}\n```\n"
        if cell.text:
            yield f"```text\n{cell.text.rstrip()}\n```\n"
        for svg in cell.figures:
            file = f"notebook_{name}.svg"
            figures[file] = svg
            yield f"![Figure of this notebook](../../pictures/{file})\n"


def _run_cell(cell: RunCell, names: dict[str, Any]) -> None:
    from matplotlib import pyplot

    tree = ast.parse(cell.source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(compile(tree, "notebook", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "notebook", "eval"), names)
            if value is not None:
                print(value)  # noqa: T201 - what the cell shows
    for number in pyplot.get_fignums():
        drawn = io.StringIO()
        pyplot.figure(number).savefig(drawn, format="svg", metadata={"Date": None})
        cell.figures.append(drawn.getvalue())
    pyplot.close("all")
    # A cell that ends with a drawing has its value alone to show, which Jupyter shows as the figure.
    if not cell.figures:
        cell.text = printed.getvalue()
