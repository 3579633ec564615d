"""Compares the depth controllers in simulated time, on the nominal robot and on variants of it.

In each variant one property is 30 % off. `measure` gives the figures of the best controller.
`python -m bench.control [FILE]` writes the table of all into docs/develop/controllers.md, and that of the
best controller with and without the numbers of crafts that differ in more. The figures use the true depth of
the sensor, without noise.
"""

import os
import sys
from collections.abc import Iterable, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path

from bench.results import CONTROLLERS as PAGE
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.craft_gains import craft_gains
from robot_runtime.simulation.water.parameters import SimulationParameters
from tests.runtime.control.depth_experiment import (
    BEST,
    SEEDS,
    STEP,
    THESIS,
    DepthFigures,
    crossing_ratio,
    known_crafts,
    perform,
    variants,
    worst,
)

_ALL, _KNOWN = "<!-- made by `make control` -->", "<!-- made by `make control`: the craft's numbers -->"
_END = "<!-- end -->"


def perform_all(controllers: Iterable[str]) -> dict[tuple[str, str], list[DepthFigures]]:
    """Return figures by controller and variant, one for each seed."""
    robots = variants()
    pairs = [(name, craft) for name in controllers for craft in robots]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        runs = {
            (name, craft): [pool.submit(perform, name, robots[craft], seed=seed) for seed in SEEDS]
            for name, craft in pairs
        }
        return {which: [run.result() for run in some] for which, some in runs.items()}


def perform_known() -> dict[str, tuple[DepthFigures, DepthFigures]]:
    """Return the best controller's worst figures on each known craft, with and without its numbers."""
    robots = known_crafts()
    with ProcessPoolExecutor(os.cpu_count()) as pool:

        def submit(robot: SimulationParameters, gains: Mapping[str, float]) -> list[Future[DepthFigures]]:
            return [pool.submit(perform, BEST, robot, seed=seed, gains=gains) for seed in SEEDS]

        runs = {
            craft: (submit(robot, {}), submit(robot, craft_gains(robot))) for craft, robot in robots.items()
        }
        return {
            craft: (worst([run.result() for run in usual]), worst([run.result() for run in knowing]))
            for craft, (usual, knowing) in runs.items()
        }


def measure() -> dict[str, float]:
    """Return the best controller's worst figures over all variants, and those of the thesis's controller."""
    figures = perform_all((BEST, THESIS))
    runs = {craft: some for (name, craft), some in figures.items() if name == BEST}
    theirs = {craft: some for (name, craft), some in figures.items() if name == THESIS}
    best = {craft: worst(some) for craft, some in runs.items()}
    thesis = worst(theirs["nominal"])
    return {
        "control.steady_cm_max": 100 * max(result.steady for result in best.values()),
        "control.overshoot_max": max(result.overshoot for result in best.values()),
        "control.crossing_ratio_max": max(crossing_ratio(runs[craft], theirs[craft]) for craft in runs),
        "control.settling_s_max": max(result.settling for result in best.values()),
        "control.rmse_cm": 100 * best["nominal"].rmse,
        "control.sine_rmse_cm": 100 * best["nominal"].sine,
        "control.bang_bang_steady_cm": 100 * thesis.steady,
        "control.bang_bang_rmse_cm": 100 * thesis.rmse,
    }


def table(results: dict[tuple[str, str], list[DepthFigures]]) -> str:
    """Return the worst figures of the nominal robot, and of all variants, as a Markdown table."""
    titles = {controller.name: controller.title for controller in CONTROLLERS["depth"]}
    lines = [
        "| controller | craft | RMSE, cm | overshoot, % | settling, s | steady p-p, cm | reached after, s | "
        "to bang-bang | strokes | sine RMSE, cm |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, title in titles.items():
        crafts = {craft: runs for (other, craft), runs in results.items() if other == name}
        nominal, *_ = crafts
        lines.append(_row(title, nominal, {nominal: crafts[nominal]}, results))
        lines.append(_row(title, f"worst of {len(crafts)}", crafts, results))
    return "\n".join(lines)


def _row(
    title: str,
    name: str,
    crafts: Mapping[str, list[DepthFigures]],
    results: Mapping[tuple[str, str], list[DepthFigures]],
) -> str:
    figures = worst([run for runs in crafts.values() for run in runs])
    ratio = max(crossing_ratio(runs, results[THESIS, craft]) for craft, runs in crafts.items())
    reached = " / ".join("-" if time >= STEP else f"{time:.2f}" for time in figures.crossings)
    settling = f"{figures.settling:.1f}" if figures.settling < STEP - 0.5 else "never"
    return (
        f"| {title} | {name} | {100 * figures.rmse:.1f} | {100 * figures.overshoot:.1f} "
        f"| {settling} | {100 * figures.steady:.1f} | {reached} | {ratio:.2f} | {figures.strokes} "
        f"| {100 * figures.sine:.1f} |"
    )


def known_table(results: Mapping[str, tuple[DepthFigures, DepthFigures]]) -> str:
    """Return the worst figures with the default gains, and with the craft's, as a Markdown table."""
    lines = [
        "| craft | gains | overshoot, % | settling, s | steady p-p, cm | reached after, s | sine RMSE, cm |",
        "|---|---|---|---|---|---|---|",
    ]
    for craft, figures in results.items():
        for gains, outcome in zip(("default", "the craft's"), figures, strict=True):
            reached = " / ".join(f"{time:.2f}" for time in outcome.crossings)
            lines.append(
                f"| {craft} | {gains} | {100 * outcome.overshoot:.1f} | {outcome.settling:.1f} "
                f"| {100 * outcome.steady:.1f} | {reached} | {100 * outcome.sine:.1f} |"
            )
    return "\n".join(lines)


def put(text: str, begin: str, made: str) -> str:
    """Return the document with this table between the mark and the next end."""
    head, rest = text.split(begin, 1)
    return f"{head}{begin}\n\n{made}\n\n{_END}{rest.split(_END, 1)[1]}"


def main() -> None:
    """Write the tables into the document."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE
    text = path.read_text(encoding="utf-8")
    text = put(text, _KNOWN, known_table(perform_known()))
    text = put(text, _ALL, table(perform_all(controller.name for controller in CONTROLLERS["depth"])))
    path.write_text(text, encoding="utf-8")
    print(f"The tables are in {path}.")


if __name__ == "__main__":
    main()
