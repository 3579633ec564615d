"""`python -m bench.figures SESSION --data FOLDER --out FOLDER`: the thesis's Figures 14 to 16 from a session.

Writes figure_14.svg, figure_15.svg and figure_16.svg, and prints what docs/use/thesis.md says of them. The
session is one of the shipped scenario figure_14; `make figures` runs that first.
"""

import argparse
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.svg import Axis, Line, Panel, draw
from server.features.sessions.recording import Recording
from server.features.sessions.session import UnknownSessionError, find_row
from server.platform.store import Reader

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

TIME = Axis("time (s)", 0.0, 60.0, 10.0)
"""That of the scenario; the recording goes on a little longer."""
SETTLED = 6.0
"""s after a change of the set point from which the oscillation is taken for the limit cycle."""
MEASURED, WANTED, THIRD = "#0072b2", "#c25200", "#4a5a64"


@dataclass(frozen=True)
class Experiment:
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
    """Exit status: 1 where there is no such session."""
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
    for number, panels in (
        (14, depth_panels(experiment)),
        (15, [output_panel(experiment)]),
        (16, [seen_panel(experiment)]),
    ):
        (options.out / f"figure_{number}.svg").write_text(draw(panels, TIME), encoding="utf-8")
    for line in figures(experiment):
        print(line)
    return 0


def read(recording: Recording, start: float) -> Experiment:
    """The experiment that a session holds."""
    end = start + TIME.last
    times, columns = recording.columns("control", ["set_point", "depth", "output"], end=end)
    documents = list(recording.documents("detection", end=end))
    return Experiment(
        times=times - start,
        depth=columns["depth"],
        set_point=columns["set_point"],
        output=columns["output"],
        looks=np.array([one["taken"] - start for one in documents]),
        seen=np.array([float(one["colour"] == "yellow") for one in documents]),
    )


def depth_panels(experiment: Experiment) -> list[Panel]:
    """Figure 14: depth and set point, and the error below."""
    times = experiment.times
    depth = [
        Line("depth", MEASURED, times, experiment.depth),
        Line("set point", WANTED, times, experiment.set_point, steps=True, dashed=True),
    ]
    error = Line("set point − depth", THIRD, times, experiment.set_point - experiment.depth)
    return [
        Panel(Axis("depth (m)", 1.2, 0.0, 0.2), depth, 260),
        Panel(Axis("error (m)", -0.6, 0.6, 0.2), [error], 130),
    ]


def output_panel(experiment: Experiment) -> Panel:
    """Figure 15: the controller's output."""
    line = Line("z of NAVIGATION, downwards", MEASURED, experiment.times, experiment.output, steps=True)
    return Panel(Axis("command", -1.2, 1.2, 0.4), [line], 200)


def seen_panel(experiment: Experiment) -> Panel:
    """Figure 16: whether the vision node found the colour."""
    line = Line("yellow is seen", MEASURED, experiment.looks, experiment.seen, steps=True)
    return Panel(Axis("detection", 0.0, 1.2, 1.0), [line], 120)


def figures(experiment: Experiment) -> list[str]:
    """The figures, one line for each change of the set point."""
    times, wanted = experiment.times, experiment.set_point
    changes = [0, *(np.flatnonzero(np.diff(wanted)) + 1), len(times)]
    lines = [describe(experiment, first, last) for first, last in pairwise(changes)]
    seen = np.flatnonzero(np.diff(experiment.seen)) + 1
    told = ", ".join(
        f"{'seen' if experiment.seen[at] else 'gone'} at {experiment.looks[at]:.3f} s" for at in seen
    )
    return [*lines, f"colour {told}"]


def describe(experiment: Experiment, first: int, last: int) -> str:
    """One set point's stretch: when it is reached, and the limit cycle about it."""
    times, wanted = experiment.times[first:last], float(experiment.set_point[first])
    error = experiment.depth[first:last] - wanted
    crossings = np.flatnonzero(np.diff(np.sign(error)))
    reached = times[crossings[0]] - times[0] if crossings.size else np.nan
    # Whole cycles alone: from one crossing downwards to another.
    downwards = [int(at) for at in crossings if error[at] < 0 and times[at] >= times[0] + SETTLED]
    cycle = error[downwards[0] : downwards[-1]]
    period = float(np.mean(np.diff(times[downwards])))
    return (
        f"{wanted:.1f} m from {times[0]:.2f} s: reached after {reached:.2f} s; limit cycle mean "
        f"{100 * cycle.mean():+.1f} cm, RMSE {100 * np.sqrt((cycle**2).mean()):.1f} cm, peak to peak "
        f"{100 * np.ptp(cycle):.1f} cm, period {period:.2f} s"
    )


if __name__ == "__main__":
    raise SystemExit(main())
