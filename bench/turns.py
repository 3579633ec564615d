"""Measures the controllers of heading, pitch and roll in simulated time.

`python -m bench.turns` prints two tables: each loop on the nominal robot, and the turns by tilted fins on all
variants. The figures use the true attitude, without the sensors' noise.
"""

import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from math import degrees, radians
from statistics import median
from typing import Any

from robot_runtime.control.attitude import euler_angles, wrap_angle
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.simulation.water.parameters import SimulationParameters
from tests.runtime.control.depth_experiment import SEEDS, read_truth, variants

DEPTH = 0.6
"""m."""
ARMED, LOOP_ON = 1.0, 3.0
"""s."""
FIRST, STEP = 15.0, 25.0
"""s; the first step comes after the dive."""
NEAR = 10.0
"""° from the set point."""
REST = 8.0
"""s at the end of each step in which the oscillation is taken."""


@dataclass(frozen=True)
class Setup:
    """A loop with its controller and gains, the steps (°), and the controller of the depth."""

    loop: str
    controller: str
    gains: dict[str, float]
    steps: tuple[float, float]
    depth: str


SETUPS = {
    "tilted fins": Setup("heading", "tilt", {}, (90.0, -143.0), "predictive"),
    "PID (kp 0.3, ki 0, kd 0.3)": Setup(
        "heading", "pid", {"kp": 0.3, "ki": 0.0, "kd": 0.3}, (90.0, -143.0), "predictive"
    ),
    "PID (kp 0.1, ki 0, kd 0.15)": Setup(
        "heading", "pid", {"kp": 0.1, "ki": 0.0, "kd": 0.15}, (90.0, -143.0), "predictive"
    ),
    "PID (kp 1.5, ki 0, kd 0.8)": Setup(
        "heading", "pid", {"kp": 1.5, "ki": 0.0, "kd": 0.8}, (90.0, -143.0), "predictive"
    ),
    "integral alone, 0.8 (pitch)": Setup(
        "pitch", "pid", {"kp": 0.0, "ki": 0.8, "kd": 0.0}, (10.0, -10.0), "pid"
    ),
    "integral alone, 0.8 (roll)": Setup("roll", "pid", {"kp": 0.0, "ki": 0.8, "kd": 0.0}, (7.0, -7.0), "pid"),
    "PID (kp 0.5, ki 0, kd 0.3; pitch)": Setup(
        "pitch", "pid", {"kp": 0.5, "ki": 0.0, "kd": 0.3}, (10.0, -10.0), "pid"
    ),
    "PID (kp 0.5, ki 0, kd 0.3; roll)": Setup(
        "roll", "pid", {"kp": 0.5, "ki": 0.0, "kd": 0.3}, (7.0, -7.0), "pid"
    ),
}


@dataclass(frozen=True)
class Turn:
    """One step of an angle."""

    near: float
    """s until it stays within `NEAR` of the set point; the step's whole time if it does not."""
    crossing: float
    """s until it first reaches the set point."""
    oscillation: float
    """°, peak to peak, over the last `REST`."""
    depth: float
    """m from the depth's set point, at most."""


class _Attitudes:
    def __init__(self, sensor: tuple[float, float, float]) -> None:
        self.samples: list[tuple[float, tuple[float, float, float], float]] = []
        self._sensor = sensor

    def blocks(self, data: bytes) -> None:
        """Store heading, pitch and roll, and the sensor's depth."""
        for time, truth, depth in read_truth(data, self._sensor):
            self.samples.append((time, euler_angles(truth.attitude), depth))

    def event(self, event: str, **more: Any) -> None:
        """Check that no command was refused."""
        assert event != "ended" or more["problem"] is None


def perform(setup: Setup, robot: SimulationParameters, seed: int) -> list[Turn]:
    """Run both steps of the loop."""
    gains = "".join(f"{name} = {value}\n" for name, value in setup.gains.items())
    events = [
        f'at = {ARMED}\ndo = "arm"\n',
        _loop(LOOP_ON, setup, 0.0) + (f"[events.gains]\n{gains}" if gains else ""),
    ]
    events += [_loop(FIRST + STEP * number, setup, step) for number, step in enumerate(setup.steps)]
    text = (
        f'name = "turns"\ntitle = "Turns"\nduration = {FIRST + STEP * len(setup.steps)}\nseed = {seed}\n'
        f'[scene]\nkind = "natural"\ndepth = 5\n'
        f'[control]\ncontroller = "{setup.depth}"\nset_point = {DEPTH}\n'
    ) + "".join(f"[[events]]\n{event}" for event in events)
    taken = _Attitudes(robot.pressure_position)
    scenario = replace(read_scenario(text), robot=robot)
    ScenarioRun(scenario, boards()["host"], taken).perform(lambda _: {})
    axis = ("heading", "pitch", "roll").index(setup.loop)
    return [
        _judge(
            [
                (time - start, degrees(wrap_angle(angles[axis] - radians(step))), depth)
                for time, angles, depth in taken.samples
                if start <= time < start + STEP
            ]
        )
        for start, step in ((FIRST + STEP * number, step) for number, step in enumerate(setup.steps))
    ]


def _loop(at: float, setup: Setup, angle: float) -> str:
    return (
        f'at = {at}\ndo = "loop"\nname = "{setup.loop}"\non = true\nset_point = {radians(angle)}\n'
        f'controller = "{setup.controller}"\n'
    )


def _judge(part: list[tuple[float, float, float]]) -> Turn:
    side = 1 if part[0][1] > 0 else -1
    rest = [error for time, error, _ in part if time >= STEP - REST]
    return Turn(
        near=max((time for time, error, _ in part if abs(error) > NEAR), default=0.0),
        crossing=next((time for time, error, _ in part if error * side <= 0 and abs(error) < 90), STEP),
        oscillation=max(rest) - min(rest),
        depth=max(abs(depth - DEPTH) for _, _, depth in part),
    )


def main() -> None:
    """Print both tables."""
    robots = variants()
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        nominal = {
            name: pool.submit(perform, setup, robots["nominal"], SEEDS[0]) for name, setup in SETUPS.items()
        }
        tilted = [
            pool.submit(perform, SETUPS["tilted fins"], robot, seed)
            for robot in robots.values()
            for seed in SEEDS
        ]
        print("| controller | within 10° after, s | first crossing, s | oscillation, ° | depth within, cm |")
        print("|---|---|---|---|---|")
        for name, run in nominal.items():
            turns = run.result()
            columns = (
                [f"{turn.near:.1f}" if turn.near < STEP - 0.5 else "never" for turn in turns],
                [f"{turn.crossing:.1f}" for turn in turns],
                [f"{turn.oscillation:.1f}" for turn in turns],
                [f"{100 * turn.depth:.1f}" for turn in turns],
            )
            print(f"| {name} | " + " | ".join(", ".join(column) for column in columns) + " |", flush=True)
        turns = [turn for run in tilted for turn in run.result()]
    times = sorted(turn.near for turn in turns)
    print(f"\n{len(turns)} turns by tilted fins: half within 10° after {median(times):.1f} s")
    print("the longest: " + ", ".join(f"{time:.1f}" for time in times[-6:]) + " s")
    print(f"depth within {100 * max(turn.depth for turn in turns):.1f} cm")


if __name__ == "__main__":
    main()
