"""An experiment with the depth controllers in simulated time: three steps and a sine, with its figures."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import pi, sin
from statistics import fmean
from typing import Any

from robot_runtime.contract.documents import Truth
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import Scenario, read_scenario
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.simulation.water.geometry import rotation, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters, Six
from robot_runtime.transport.blocks import read_blocks, read_rows

BEST, THESIS = "predictive", "bang_bang"
SEEDS = (3, 4, 5)
"""Of the sensors' noise, which also decides the phase of a limit cycle when a step begins."""
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


def variants() -> dict[str, SimulationParameters]:
    """Return the simulated robots: the nominal one, and variants with one property 30 % off.

    Buoyancy means what is left over the weight, 0.3 % of it: 30 % of the whole would throw the robot out
    of the water. Mass is the hull's, trimmed anew; drag is the hull's, linear and quadratic; thrust is the
    fins'.
    """
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


def known_crafts() -> dict[str, SimulationParameters]:
    """Crafts that differ in more than one number, or in what no motion reveals to the controller."""
    plain = SimulationParameters()

    def weighing(factor: float) -> SimulationParameters:
        x, y, z = plain.inertia
        return replace(plain, mass=plain.mass * factor, inertia=(x * factor, y * factor, z * factor))

    heavy = replace(weighing(1.3), buoyancy=1.0021)
    late = replace(plain.pressure, latency=plain.pressure.latency + 0.1)
    return {
        "mass +30 %, buoyancy -30 %": heavy,
        "the same, fins act 0.05 s later": replace(heavy, fin_delay=0.05),
        "mass -30 %, thrust and buoyancy +30 %, fins act 0.05 s later": replace(
            weighing(0.7), buoyancy=1.0039, fin_drag=plain.fin_drag * 1.3, fin_delay=0.05
        ),
        "depth 0.1 s later": replace(plain, pressure=late),
        "blades' drag doubled": replace(plain, fin_normal=2 * plain.fin_normal),
        "sinks: buoyancy 0.3 % below the weight": replace(plain, buoyancy=0.997),
    }


@dataclass(frozen=True)
class DepthFigures:
    """Figures of one controller on one robot: the worst of the three steps, unless stated otherwise."""

    rmse: float
    """m, over all three."""
    overshoot: float
    """Share of the step."""
    settling: float
    """s until it stays within ±2 cm; the step's whole time if it does not."""
    steady: float
    """m, from peak to peak."""
    crossings: tuple[float, ...]
    """s until the set point is reached, of each step."""
    strokes: int
    """Of all four fins together, over all three."""
    sine: float
    """m, RMSE while the set point follows a sine."""


@dataclass(frozen=True)
class DepthSample:
    """The true state: time (s), depth of the sensor (m) and fin angles (rad)."""

    time: float
    depth: float
    fins: tuple[float, ...]


def read_truth(data: bytes, sensor: tuple[float, float, float]) -> Iterator[tuple[float, Truth, float]]:
    """Yield each truth in these blocks: time (s), truth, and depth (m) of this point of the hull."""
    for block in read_blocks(data):
        if block.topic.name == "truth":
            for time, truth in read_rows(block):
                assert isinstance(truth, Truth)
                above = to_world(rotation(truth.attitude), sensor)[2]
                yield time, truth, truth.position[2] + above


class _TruthRecorder:
    def __init__(self, sensor: tuple[float, float, float]) -> None:
        self.samples: list[DepthSample] = []
        self._sensor = sensor

    def blocks(self, data: bytes) -> None:
        """Store the truth."""
        for time, truth, depth in read_truth(data, self._sensor):
            self.samples.append(DepthSample(time, depth, truth.fins))

    def event(self, event: str, **more: Any) -> None:
        """Ignore the message."""


def experiment(
    controller: str,
    robot: SimulationParameters,
    *,
    sine: bool = True,
    seed: int = SEEDS[0],
    gains: Mapping[str, float] | None = None,
) -> Scenario:
    """Return the scenario: three steps, and a sine.

    `gains` are those that differ from the controller's defaults.
    """
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
    scenario = read_scenario(text)
    control = replace(scenario.control, gains={controller: dict(gains or {})})
    return replace(scenario, robot=robot, control=control)


def perform(
    controller: str,
    robot: SimulationParameters,
    *,
    sine: bool = True,
    seed: int = SEEDS[0],
    gains: Mapping[str, float] | None = None,
) -> DepthFigures:
    """Run the scenario and return its figures."""
    taken = _TruthRecorder(robot.pressure_position)
    scenario = experiment(controller, robot, sine=sine, seed=seed, gains=gains)
    ScenarioRun(scenario, boards()["host"], taken).perform(lambda _: {})
    return judge(taken.samples)


def judge(samples: Sequence[DepthSample]) -> DepthFigures:
    """Return the figures of the whole experiment; `sine` is NaN without one."""
    starts = [ARMED + STEP * number for number in range(len(SET_POINTS))]
    overshoots, settlings, steadies, crossings = [], [], [], []
    squares: list[float] = []
    before = 0.0
    for start, set_point in zip(starts, SET_POINTS, strict=True):
        part = [
            (sample.time - start, sample.depth) for sample in samples if start <= sample.time < start + STEP
        ]
        size, side = abs(set_point - before), 1 if set_point > before else -1
        remaining = [(time, (set_point - depth) * side) for time, depth in part]
        squares += [error**2 for _, error in remaining]
        overshoots.append(max(0.0, -min(error for _, error in remaining)) / size)
        settlings.append(max((time for time, error in remaining if abs(error) > BAND), default=0.0))
        crossings.append(next((time for time, error in remaining if error <= 0), STEP))
        rest = [depth for time, depth in part if time >= STEP - STEADY]
        steadies.append(max(rest) - min(rest))
        before = set_point
    end = starts[-1] + STEP
    # The first quarter is the transition to the sine.
    waving = [sample for sample in samples if end + SINE_PERIOD / 4 <= sample.time < end + SINE_PERIOD]
    return DepthFigures(
        rmse=_root_mean(squares),
        overshoot=max(overshoots),
        settling=max(settlings),
        steady=max(steadies),
        crossings=tuple(crossings),
        strokes=sum(
            _strokes([sample.fins[fin] for sample in samples if sample.time < end]) for fin in range(4)
        ),
        sine=_root_mean([(sample.depth - _sine(sample.time - end)) ** 2 for sample in waving]),
    )


def worst(runs: Sequence[DepthFigures]) -> DepthFigures:
    """Return the worst of each figure."""
    return DepthFigures(
        rmse=max(run.rmse for run in runs),
        overshoot=max(run.overshoot for run in runs),
        settling=max(run.settling for run in runs),
        steady=max(run.steady for run in runs),
        crossings=tuple(max(times) for times in zip(*(run.crossings for run in runs), strict=True)),
        strokes=max(run.strokes for run in runs),
        sine=max(run.sine for run in runs),
    )


def crossing_ratio(runs: Sequence[DepthFigures], others: Sequence[DepthFigures]) -> float:
    """Ratio of the times to reach the set point, from the surface or in all three steps, whichever is worse.

    The phase of a limit cycle at the beginning of a step is random. So single later steps are not compared,
    and of the other controller the mean run counts.
    """
    first = fmean(other.crossings[0] for other in others)
    every = fmean(sum(other.crossings) for other in others)
    return max(max(run.crossings[0] / first, sum(run.crossings) / every) for run in runs)


def _scaled(six: Six, factor: float) -> Six:
    a, b, c, d, e, f = (number * factor for number in six)
    return a, b, c, d, e, f


def _sine(time: float) -> float:
    return round(SINE_CENTRE + SINE_SIZE * sin(2 * pi * time / SINE_PERIOD), 4)


def _root_mean(squares: Sequence[float]) -> float:
    return (sum(squares) / len(squares)) ** 0.5 if squares else float("nan")


def _strokes(angles: Sequence[float]) -> int:
    """Count of strokes, there and back; jumps through ±π do not count."""
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
