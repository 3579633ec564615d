"""Scenarios in simulated time: simulated seconds in each second of the processor's time, and of the wall's.

The first stays whatever else the computer does. The processes of a run on the emulated board never work at
the same time, so that theirs add up.
"""

import os
import time
from dataclasses import replace

from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.library import shipped_scenarios
from robot_runtime.experiments.scenario.run import AFTERWARDS, PRELUDE, ScenarioRun, Unheard

_SCENARIO = "hover_in_a_current"


def measure() -> dict[str, float]:
    """Measure physics, firmware and control, no camera: depth is held in a current, and later in waves."""
    host, host_wall = _speeds("host", 60.0)
    board, board_wall = _speeds("emulated", 20.0)
    return {
        "scenario.speed_x": host,
        "scenario.speed_wall_x": host_wall,
        "scenario.speed_board_x": board,
        "scenario.speed_board_wall_x": board_wall,
    }


def _speeds(board: str, duration: float) -> tuple[float, float]:
    """Return the speeds by the processor's time, and by the wall's."""
    whole = read_scenario(shipped_scenarios()[_SCENARIO])
    events = tuple(event for event in whole.events if event.at <= duration)
    run = ScenarioRun(replace(whole, duration=duration, events=events), boards()[board], Unheard())
    began, wall = _processor_time(), time.monotonic()
    run.perform(lambda _: {})
    simulated = PRELUDE + duration + AFTERWARDS
    return simulated / (_processor_time() - began), simulated / (time.monotonic() - wall)


def _processor_time() -> float:
    """Return the processor s of this process and of its children that have ended."""
    return sum(os.times()[:4])
