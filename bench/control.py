"""Compares the depth controllers in simulated time, on the nominal robot and on variants of it.

In each variant one property is 30 % off. `measure` gives the figures of the best controller.
`python -m bench.control [FILE]` writes the table of all into docs/develop/proofs/control.md, and that of the
best controller with and without the numbers of crafts that differ in more. The figures use the true depth of
the sensor, without noise.
"""

import os
import sys
from collections.abc import Iterable, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path

from bench.results import PROOFS
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.craft_gains import craft_gains
from robot_runtime.simulation.water.parameters import SimulationParameters
from tests.runtime.control.depth_experiment import (
    BEST,
    SEEDS,
    STEP,
    THESIS,
    Figures,
    crossing_ratio,
    known_crafts,
    perform,
    variants,
    worst,
)

_ALL, _KNOWN = "<!-- made by `make control` -->", "<!-- made by `make control`: the craft's numbers -->"
_END = "<!-- end -->"


def perform_all(controllers: Iterable[str]) -> dict[tuple[str, str], list[Figures]]:
    """Figures by controller and variant, one for each seed."""
    robots = variants()
    pairs = [(name, craft) for name in controllers for craft in robots]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        runs = {
            (name, craft): [pool.submit(perform, name, robots[craft], seed=seed) for seed in SEEDS]
            for name, craft in pairs
        }
        return {which: [one.result() for one in some] for which, some in runs.items()}


def perform_known() -> dict[str, tuple[Figures, Figures]]:
    """The best controller's worst figures on each known craft, without and with the craft's numbers."""
    robots = known_crafts()
    with ProcessPoolExecutor(os.cpu_count()) as pool:

        def submit(robot: SimulationParameters, gains: Mapping[str, float]) -> list[Future[Figures]]:
            return [pool.submit(perform, BEST, robot, seed=seed, gains=gains) for seed in SEEDS]

        runs = {
            craft: (submit(robot, {}), submit(robot, craft_gains(robot))) for craft, robot in robots.items()
        }
        return {
            craft: (worst([one.result() for one in usual]), worst([one.result() for one in knowing]))
            for craft, (usual, knowing) in runs.items()
        }


def measure() -> dict[str, float]:
    """The best controller's worst figures over all variants, and those of the thesis's controller."""
    found = perform_all((BEST, THESIS))
    runs = {craft: some for (name, craft), some in found.items() if name == BEST}
    theirs = {craft: some for (name, craft), some in found.items() if name == THESIS}
    best = {craft: worst(some) for craft, some in runs.items()}
    thesis = worst(theirs["nominal"])
    return {
        "control.steady_cm_max": 100 * max(one.steady for one in best.values()),
        "control.overshoot_max": max(one.overshoot for one in best.values()),
        "control.crossing_ratio_max": max(crossing_ratio(runs[craft], theirs[craft]) for craft in runs),
        "control.settling_s_max": max(one.settling for one in best.values()),
        "control.rmse_cm": 100 * best["nominal"].rmse,
        "control.sine_rmse_cm": 100 * best["nominal"].sine,
        "control.bang_bang_steady_cm": 100 * thesis.steady,
        "control.bang_bang_rmse_cm": 100 * thesis.rmse,
    }


def table(found: dict[tuple[str, str], list[Figures]]) -> str:
    """The worst figures as a Markdown table."""
    titles = {one.name: one.title for one in CONTROLLERS["depth"]}
    lines = [
        "| controller | craft | RMSE, cm | overshoot, % | settling, s | steady p-p, cm | reached after, s | "
        "to bang-bang | strokes | sine RMSE, cm |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for (name, craft), runs in found.items():
        one = worst(runs)
        reached = " / ".join("-" if time >= STEP else f"{time:.2f}" for time in one.crossings)
        settling = f"{one.settling:.1f}" if one.settling < STEP - 0.5 else "never"
        lines.append(
            f"| {titles[name]} | {craft} | {100 * one.rmse:.1f} | {100 * one.overshoot:.1f} | {settling} "
            f"| {100 * one.steady:.1f} | {reached} | {crossing_ratio(runs, found[THESIS, craft]):.2f} "
            f"| {one.strokes} | {100 * one.sine:.1f} |"
        )
    return "\n".join(lines)


def known_table(found: Mapping[str, tuple[Figures, Figures]]) -> str:
    """The worst figures with the default gains, and with the craft's, as a Markdown table."""
    lines = [
        "| craft | gains | overshoot, % | settling, s | steady p-p, cm | reached after, s | sine RMSE, cm |",
        "|---|---|---|---|---|---|---|",
    ]
    for craft, figures in found.items():
        for gains, one in zip(("default", "the craft's"), figures, strict=True):
            reached = " / ".join(f"{time:.2f}" for time in one.crossings)
            lines.append(
                f"| {craft} | {gains} | {100 * one.overshoot:.1f} | {one.settling:.1f} "
                f"| {100 * one.steady:.1f} | {reached} | {100 * one.sine:.1f} |"
            )
    return "\n".join(lines)


def put(text: str, begin: str, made: str) -> str:
    """The document with this table between the mark and the next end."""
    head, rest = text.split(begin, 1)
    return f"{head}{begin}\n\n{made}\n\n{_END}{rest.split(_END, 1)[1]}"


def main() -> None:
    """Writes the tables into the document."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else PROOFS / "control.md"
    text = path.read_text(encoding="utf-8")
    text = put(text, _KNOWN, known_table(perform_known()))
    text = put(text, _ALL, table(perform_all(one.name for one in CONTROLLERS["depth"])))
    path.write_text(text, encoding="utf-8")
    print(f"The tables are in {path}.")


if __name__ == "__main__":
    main()
