"""The table of a sweep: a row for each run that is done, the same from page, shell and Python."""

from collections.abc import Iterator, Sequence

from robot_runtime.experiments.sweep.document import Sweep
from server.analysis.definitions import RUN_FIGURES
from server.features.sweeps.store import StoredRun
from server.features.sweeps.variants import find_failure
from server.platform.csv_cells import STYLES, escape_formula


def write_table(sweep: Sweep, runs: Sequence[StoredRun]) -> str:
    """Return the runs as CSV: number, variant, seed, values, figures, and why a run failed.

    Numbers are written so that the same ones are read back; a missing figure is an empty cell.
    """
    names = [parameter.name for parameter in sweep.parameters]
    head = ["run", "variant", "seed", *names, *(meaning.name for meaning in RUN_FIGURES), "problem"]
    return STYLES["none"].write([head, *_lines(sweep, runs)])


def _lines(sweep: Sweep, runs: Sequence[StoredRun]) -> Iterator[list[object]]:
    for run in runs:
        figures = [run.outcome.figures.get(meaning.name) for meaning in RUN_FIGURES]
        problem = find_failure(sweep.figures.best, run.outcome)
        values = [escape_formula(value) if isinstance(value, str) else value for value in run.values]
        yield [run.number, run.variant, run.seed, *values, *figures, escape_formula(problem)]
