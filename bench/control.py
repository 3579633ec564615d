"""The depth controllers beside each other, in simulated time: nominal craft, and each thing 30 % off.

`measure` gives the figures of the best; `python -m bench.control [FILE]` writes the table of all into the
marked place of docs/develop/proofs/control.md. What is judged is the depth that the simulated sensor really
had, without its noise.
"""

import os
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise
from math import pi, sin
from pathlib import Path
from statistics import fmean
from typing import Any

from robot_runtime.contract.documents import Truth
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import Scenario, read_scenario
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.simulation.water.geometry import rotation, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters, Six
from robot_runtime.transport.blocks import read_blocks, read_rows

BEST, THESIS = "predictive", "bang_bang"
SEEDS = (3, 4, 5)
"""Of the sensors' noise, and so of where a limit cycle stands when a step begins."""
ARMED = 1.0
"""s; the first step begins here, at the surface."""
STEP = 20.0
"""s between two steps."""
SET_POINTS = (0.5, 1.0, 0.5)
"""m."""
STEADY = 8.0
"""s at the end of each step over which peak-to-peak is taken."""
BAND = 0.02
"""m about the set point."""
SINE_CENTRE, SINE_SIZE, SINE_PERIOD = 0.6, 0.1, 20.0
"""m, m, s; the set point is moved five times a second."""
_STROKE = 0.1
"""rad that a fin must swing for it to count."""
_BEGIN, _END = "<!-- made by `make control` -->", "<!-- end -->"


def variants() -> dict[str, SimulationParameters]:
    """The simulated robots. Buoyancy is that which is left over the weight, 0.3 % of it: 30 % of the whole
    would fling any craft out of the water. Mass is that of the hull, trimmed anew; drag is the hull's, linear
    and quadratic; thrust is that of the fins."""
    plain = SimulationParameters()
    made = {"nominal": plain}
    for sign, factor in (("-", 0.7), ("+", 1.3)):
        x, y, z = plain.inertia
        made |= {
            f"mass {sign}30 %": replace(
                plain, mass=plain.mass * factor, inertia=(x * factor, y * factor, z * factor)
            ),
            f"buoyancy {sign}30 %": replace(plain, buoyancy=1 + (plain.buoyancy - 1) * factor),
            f"drag {sign}30 %": replace(
                plain,
                damping_linear=_scaled(plain.damping_linear, factor),
                damping_quadratic=_scaled(plain.damping_quadratic, factor),
            ),
            f"thrust {sign}30 %": replace(plain, fin_drag=plain.fin_drag * factor),
        }
    return made


@dataclass(frozen=True)
class Figures:
    """Of one controller on one craft; the worst of the three steps where nothing else is said."""

    rmse: float
    """m, over all three."""
    overshoot: float
    """Share of the step."""
    settling: float
    """s until it stays within ±2 cm; the step's whole time where it does not."""
    steady: float
    """m, from peak to peak."""
    crossings: tuple[float, ...]
    """s until the set point is reached, of each step."""
    strokes: int
    """Of all four fins together, over all three."""
    sine: float
    """m, RMSE while the set point follows a sine."""


@dataclass(frozen=True)
class Sample:
    """What really was: time (s), depth of the sensor (m) and fin angles (rad)."""

    time: float
    depth: float
    fins: tuple[float, ...]


class _Taken:
    def __init__(self, sensor: tuple[float, float, float]) -> None:
        self.samples: list[Sample] = []
        self._sensor = sensor

    def blocks(self, data: bytes) -> None:
        """Keep the truth."""
        for block in read_blocks(data):
            if block.topic.name == "truth":
                for time, truth in read_rows(block):
                    assert isinstance(truth, Truth)
                    above = to_world(rotation(truth.attitude), self._sensor)[2]
                    self.samples.append(Sample(time, truth.position[2] + above, truth.fins))

    def event(self, event: str, **more: Any) -> None:
        """Nothing is made of it."""


def experiment(
    controller: str, robot: SimulationParameters, *, sine: bool = True, seed: int = SEEDS[0]
) -> Scenario:
    """Three steps, and a sine."""
    steps_end = ARMED + STEP * len(SET_POINTS)
    duration = steps_end + (SINE_PERIOD if sine else 0.0)
    events = [(ARMED + STEP * number, depth) for number, depth in enumerate(SET_POINTS) if number]
    if sine:
        events += [(steps_end + 0.2 * number, _sine(0.2 * number)) for number in range(int(SINE_PERIOD * 5))]
    text = (
        f'name = "control"\ntitle = "Control"\nduration = {duration}\nseed = {seed}\n'
        '[scene]\nkind = "natural"\ndepth = 5\n'
        f'[control]\ncontroller = "{controller}"\nset_point = {SET_POINTS[0]}\n'
        f'[[events]]\nat = {ARMED}\ndo = "arm"\n'
    )
    text += "".join(f'[[events]]\nat = {at}\ndo = "set_points"\ndefault = {depth}\n' for at, depth in events)
    return replace(read_scenario(text), robot=robot)


def perform(
    controller: str, robot: SimulationParameters, *, sine: bool = True, seed: int = SEEDS[0]
) -> Figures:
    """Let it swim, and judge it."""
    taken = _Taken(robot.pressure_position)
    ScenarioRun(experiment(controller, robot, sine=sine, seed=seed), boards()["host"], taken).perform(
        lambda _: {}
    )
    return judge(taken.samples)


def judge(samples: Sequence[Sample]) -> Figures:
    """The figures of the whole experiment; `sine` is nan where there was none."""
    starts = [ARMED + STEP * number for number in range(len(SET_POINTS))]
    overshoots, settlings, steadies, crossings = [], [], [], []
    squares: list[float] = []
    before = 0.0
    for start, wanted in zip(starts, SET_POINTS, strict=True):
        part = [(one.time - start, one.depth) for one in samples if start <= one.time < start + STEP]
        size, side = abs(wanted - before), 1 if wanted > before else -1
        left = [(time, (wanted - depth) * side) for time, depth in part]
        squares += [error**2 for _, error in left]
        overshoots.append(max(0.0, -min(error for _, error in left)) / size)
        settlings.append(max((time for time, error in left if abs(error) > BAND), default=0.0))
        crossings.append(next((time for time, error in left if error <= 0), STEP))
        rest = [depth for time, depth in part if time >= STEP - STEADY]
        steadies.append(max(rest) - min(rest))
        before = wanted
    end = starts[-1] + STEP
    # Its first quarter is for getting there.
    waving = [one for one in samples if end + SINE_PERIOD / 4 <= one.time < end + SINE_PERIOD]
    return Figures(
        rmse=_root_mean(squares),
        overshoot=max(overshoots),
        settling=max(settlings),
        steady=max(steadies),
        crossings=tuple(crossings),
        strokes=sum(_strokes([one.fins[fin] for one in samples if one.time < end]) for fin in range(4)),
        sine=_root_mean([(one.depth - _sine(one.time - end)) ** 2 for one in waving]),
    )


def worst(runs: Sequence[Figures]) -> Figures:
    """The worst of each figure."""
    return Figures(
        rmse=max(one.rmse for one in runs),
        overshoot=max(one.overshoot for one in runs),
        settling=max(one.settling for one in runs),
        steady=max(one.steady for one in runs),
        crossings=tuple(max(times) for times in zip(*(one.crossings for one in runs), strict=True)),
        strokes=max(one.strokes for one in runs),
        sine=max(one.sine for one in runs),
    )


def crossing_ratio(runs: Sequence[Figures], others: Sequence[Figures]) -> float:
    """By how much slower than another it reaches the set point: from the surface, or in all three steps.

    Where a limit cycle stands when a step begins is luck, so that single later steps are not compared, and
    the other's are those of its mean run.
    """
    first = fmean(one.crossings[0] for one in others)
    every = fmean(sum(one.crossings) for one in others)
    return max(max(one.crossings[0] / first, sum(one.crossings) / every) for one in runs)


def perform_all() -> dict[tuple[str, str], list[Figures]]:
    """By controller and craft; one of each seed."""
    crafts = variants()
    wanted = [(one.name, craft) for one in CONTROLLERS["depth"] for craft in crafts]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        runs = {
            (name, craft): [pool.submit(perform, name, crafts[craft], seed=seed) for seed in SEEDS]
            for name, craft in wanted
        }
        return {which: [one.result() for one in some] for which, some in runs.items()}


def measure() -> dict[str, float]:
    """The best controller's worst figures over all crafts, beside the thesis's controller."""
    found = perform_all()
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
    """The worst figures as a table for people."""
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


def main() -> None:
    """Write the table into the document."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/develop/proofs/control.md")
    made = table(perform_all())
    text = path.read_text(encoding="utf-8")
    head, rest = text.split(_BEGIN, 1)
    tail = rest.split(_END, 1)[1]
    path.write_text(f"{head}{_BEGIN}\n\n{made}\n\n{_END}{tail}", encoding="utf-8")
    print(f"The table is in {path}.")


def _scaled(six: Six, factor: float) -> Six:
    a, b, c, d, e, f = (one * factor for one in six)
    return a, b, c, d, e, f


def _sine(time: float) -> float:
    return round(SINE_CENTRE + SINE_SIZE * sin(2 * pi * time / SINE_PERIOD), 4)


def _root_mean(squares: Sequence[float]) -> float:
    return (sum(squares) / len(squares)) ** 0.5 if squares else float("nan")


def _strokes(angles: Sequence[float]) -> int:
    """There and back counts as one; steps through ±π do not."""
    turned = [0.0]
    for before, after in pairwise(angles):
        turned.append(turned[-1] + (after - before + pi) % (2 * pi) - pi)
    swings, far, rising = 0, turned[0], True
    for angle in turned:
        if (angle > far) == rising:
            far = angle
        elif abs(angle - far) >= _STROKE:
            swings, far, rising = swings + 1, angle, not rising
    return swings // 2


if __name__ == "__main__":
    main()
