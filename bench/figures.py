"""`python -m bench.figures SESSION --data FOLDER --out FOLDER`: the thesis's Figures 14 to 16 from a session.

Writes figure_14.svg, figure_15.svg and figure_16.svg, and prints what docs/use/thesis.md says of them. The
session is one of the shipped scenario figure_14; `make figures` runs that first.
"""

import argparse
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from server.library.content import Recording
from server.platform.store import Reader
from server.recording.session import UnknownSessionError, find_row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

DURATION = 60.0
"""s, that of the scenario; the recording goes on a little longer."""
SETTLED = 6.0
"""s after a change of the set point from which the oscillation is taken for the limit cycle."""
MEASURED, SET_POINT, ERROR = "#0072b2", "#c25200", "#4a5a64"
STYLE: dict[Any, Any] = {
    "svg.hashsalt": "mucat",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "figure.facecolor": "white",
    "text.color": "#0d1a22",
    "lines.linewidth": 1.2,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#90a4ae",
    "grid.color": "#dde4e9",
}


@dataclass(frozen=True)
class RecordedExperiment:
    """The recorded data; times in s since the session's start, depths in m."""

    times: "Floats"
    depth: "Floats"
    set_point: "Floats"
    output: "Floats"
    looks: "Floats"
    """Times of the vision node's pictures."""
    seen: "Floats"
    """1 where the target colour was in them, else 0."""


def main() -> int:
    """Write the figures. Return the exit status: 1 where there is no such session."""
    parser = argparse.ArgumentParser(prog="python -m bench.figures", description=__doc__)
    parser.add_argument("session", type=int)
    parser.add_argument("--data", type=Path, default=Path("data"))
    parser.add_argument("--out", type=Path, default=Path("docs/pictures"))
    options = parser.parse_args()
    with closing(Reader(options.data / "mucat.db")) as store:
        try:
            row = find_row(store, options.session)
        except UnknownSessionError as problem:
            print(problem)
            return 1
        experiment = read(Recording(store, row), row.started_steady)
    with matplotlib.rc_context(STYLE):
        for number, figure in ((14, draw_depth), (15, draw_output), (16, draw_detection)):
            figure(experiment).savefig(options.out / f"figure_{number}.svg", metadata={"Date": None})
    for line in figures(experiment):
        print(line)
    return 0


def read(recording: Recording, start: float) -> RecordedExperiment:
    """Return the experiment that a session holds."""
    end = start + DURATION
    times, columns = recording.columns("control", ["set_point", "depth", "output"], end=end)
    documents = list(recording.documents("detection", end=end))
    return RecordedExperiment(
        times=times - start,
        depth=columns["depth"],
        set_point=columns["set_point"],
        output=columns["output"],
        looks=np.array([document["taken"] - start for document in documents]),
        seen=np.array([float(document["colour"] == "yellow") for document in documents]),
    )


def draw_depth(experiment: RecordedExperiment) -> Figure:
    """Figure 14: depth and set point, and the error below."""
    figure = Figure((9, 5), layout="constrained")
    depth, error = figure.subplots(2, sharex=True, height_ratios=(2, 1))
    times, set_point = experiment.times, experiment.set_point
    depth.plot(times, experiment.depth, color=MEASURED, label="depth")
    depth.step(times, set_point, "--", where="post", color=SET_POINT, label="set point")
    _finish(depth, "depth (m)", 1.2, 0)
    error.plot(times, set_point - experiment.depth, color=ERROR, label="set point − depth")
    _finish(error, "error (m)", -0.6, 0.6)
    error.set_xlabel("time (s)")
    return figure


def draw_output(experiment: RecordedExperiment) -> Figure:
    """Figure 15: the controller's output."""
    return _draw_steps(experiment.times, experiment.output, "z of NAVIGATION, downwards", "command", -1.2)


def draw_detection(experiment: RecordedExperiment) -> Figure:
    """Figure 16: whether the vision node found the colour."""
    return _draw_steps(experiment.looks, experiment.seen, "yellow is seen", "detection", 0)


def _draw_steps(times: "Floats", values: "Floats", label: str, title: str, bottom: float) -> Figure:
    figure = Figure((9, 2.5), layout="constrained")
    axes = figure.subplots()
    axes.step(times, values, where="post", color=MEASURED, label=label)
    _finish(axes, title, bottom, 1.2)
    axes.set_xlabel("time (s)")
    return figure


def _finish(axes: "Axes", title: str, bottom: float, top: float) -> None:
    axes.set(ylabel=title, ylim=(bottom, top), xlim=(0, DURATION))
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False, borderaxespad=0)


def figures(experiment: RecordedExperiment) -> list[str]:
    """Return the figures, one line for each change of the set point."""
    times, set_points = experiment.times, experiment.set_point
    changes = [0, *(np.flatnonzero(np.diff(set_points)) + 1), len(times)]
    lines = [describe(experiment, first, last) for first, last in pairwise(changes)]
    seen = np.flatnonzero(np.diff(experiment.seen)) + 1
    text = ", ".join(
        f"{'seen' if experiment.seen[at] else 'gone'} at {experiment.looks[at]:.3f} s" for at in seen
    )
    return [*lines, f"colour {text}"]


def describe(experiment: RecordedExperiment, first: int, last: int) -> str:
    """Return one set point's stretch as text: the time until it is reached, and the limit cycle about it."""
    times, set_point = experiment.times[first:last], float(experiment.set_point[first])
    error = experiment.depth[first:last] - set_point
    crossings = np.flatnonzero(np.diff(np.sign(error)))
    reached = times[crossings[0]] - times[0] if crossings.size else np.nan
    # Whole cycles alone: from one crossing downwards to another.
    downwards = [int(at) for at in crossings if error[at] < 0 and times[at] >= times[0] + SETTLED]
    cycle = error[downwards[0] : downwards[-1]]
    period = float(np.mean(np.diff(times[downwards])))
    return (
        f"{set_point:.1f} m from {times[0]:.2f} s: reached after {reached:.2f} s; limit cycle mean "
        f"{100 * cycle.mean():+.1f} cm, RMSE {100 * np.sqrt((cycle**2).mean()):.1f} cm, peak to peak "
        f"{100 * np.ptp(cycle):.1f} cm, period {period:.2f} s"
    )


if __name__ == "__main__":
    raise SystemExit(main())
