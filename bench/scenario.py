"""Scenarios in simulated time: simulated seconds in each second of the processor's time.

Of the processor's and not of the wall's: whatever else the computer does, the figure stays. The two kinds of
process on the emulated board never work at the same time, so that theirs add up.
"""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import robot_runtime.experiments.scenario
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.run import AFTERWARDS, PRELUDE, ScenarioRun

_SCENARIO = Path(robot_runtime.experiments.scenario.__file__).parent / "shipped/hover_in_a_current.toml"


class _Deaf:
    def blocks(self, data: bytes) -> None:
        """Nothing is made of it."""

    def event(self, event: str, **more: Any) -> None:
        """Nor of this."""


def measure() -> dict[str, float]:
    """Physics, firmware and control, no camera: depth is held in a current, and later in waves."""
    return {
        "scenario.speed_x": _speed("host", 60.0),
        "scenario.speed_board_x": _speed("emulated", 20.0),
    }


def _speed(board: str, duration: float) -> float:
    whole = read_scenario(_SCENARIO.read_text())
    events = tuple(event for event in whole.events if event.at <= duration)
    run = ScenarioRun(replace(whole, duration=duration, events=events), boards()[board], _Deaf())
    began = _processor_time()
    run.perform(lambda _: {})
    return (PRELUDE + duration + AFTERWARDS) / (_processor_time() - began)


def _processor_time() -> float:
    """s of this process and of its children that have ended."""
    return sum(os.times()[:4])
