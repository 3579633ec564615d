"""Depth controllers against a simple plant, and the gains they refuse."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.controllers.bang_bang import BangBang, BangBangDeadZone
from robot_runtime.control.controllers.base import Controller
from robot_runtime.control.controllers.pid import Pid

SECONDS = 0.1


def dive(controller: Controller, set_point: float, seconds: float, push: float = 0.0) -> list[float]:
    """Depths of a damped body under the controller's command, from the surface; push is a steady force."""
    depth = speed = 0.0
    depths = []
    for _ in range(round(seconds / SECONDS)):
        command = controller.step(set_point, round(depth, 3), SECONDS)
        for _ in range(20):
            speed += (1.8 * command + push - 1.5 * speed - 35 * speed * abs(speed)) / 6.2 * SECONDS / 20
            depth += speed * SECONDS / 20
        depths.append(depth)
    return depths


def crossings(depths: list[float], level: float) -> int:
    return sum((a - level) * (b - level) < 0 for a, b in pairwise(depths))


@given(st.floats(0, 10), st.floats(0, 10))
def test_bang_bang_is_all_or_nothing(set_point: float, depth: float) -> None:
    command = BangBang().step(set_point, depth, SECONDS)
    assert command == (0.0 if set_point == depth else math.copysign(1.0, set_point - depth))


def test_bang_bang_oscillates_about_the_set_point() -> None:
    depths = dive(BangBang(), 0.5, 60)[200:]
    assert crossings(depths, 0.5) > 10
    assert max(depths) - min(depths) < 0.3


def test_the_dead_zone_gives_no_command_inside_and_full_command_outside() -> None:
    controller = BangBangDeadZone()
    controller.tune({"dead_zone": 0.1})
    assert [controller.step(1.0, depth, SECONDS) for depth in (0.85, 0.95, 1.0, 1.05, 1.15)] == [
        1,
        0,
        0,
        0,
        -1,
    ]


def test_pid_settles_without_error_under_a_steady_push() -> None:
    for push in (-0.3, 0.0, 0.3):
        depths = dive(Pid(), 0.5, 60, push)
        assert depths[-100:] == pytest.approx([0.5] * 100, abs=0.02)


def test_the_integral_does_not_wind_up_while_the_command_is_at_its_limit() -> None:
    controller = Pid()
    for _ in range(600):
        assert controller.step(10.0, 0.0, SECONDS) == 1.0
    assert abs(controller._integral) <= 0.4 * 10.0 * SECONDS


def test_a_step_of_the_set_point_gives_no_kick_of_the_derivative() -> None:
    controller = Pid()
    controller.tune({"kp": 0.0, "ki": 0.0, "kd": 50.0})
    assert [controller.step(set_point, 0.3, SECONDS) for set_point in (0.3, 9.0, 0.3)] == [0, 0, 0]


def test_start_resets_the_controller() -> None:
    used, fresh = Pid(), Pid()
    dive(used, 0.5, 5)
    used.start()
    assert used.step(1.0, 0.4, SECONDS) == fresh.step(1.0, 0.4, SECONDS)


@pytest.mark.parametrize("make", CONTROLLERS["depth"], ids=lambda cls: cls.name)
@pytest.mark.parametrize(
    "spoil",
    [
        lambda _: math.nan,
        lambda _: math.inf,
        lambda limits: limits[1] + 0.001,
        lambda limits: limits[0] - 0.001,
        lambda _: "1",
        lambda _: True,
    ],
    ids=["nan", "infinite", "above", "below", "text", "truth value"],
)
def test_bad_gains_are_refused_and_change_nothing(
    make: type[Controller], spoil: Callable[[tuple[float, float]], Any]
) -> None:
    for name, limits in make.limits.items():
        controller = make()
        good = {other: each.minimum for other, each in make.limits.items() if other != name}
        bad = spoil((limits.minimum, limits.maximum))
        with pytest.raises(ValueError, match=name):
            controller.tune(good | {name: bad})
        assert controller.gains == make().gains


def test_an_unknown_gain_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"no gain 'kq'; it has kp, ki, kd"):
        Pid().tune({"kq": 1.0})


@given(st.floats(0, 10), st.floats(-1, 11), st.floats(0, 1))
def test_commands_stay_within_their_limits(set_point: float, depth: float, seconds: float) -> None:
    for cls in CONTROLLERS["depth"]:
        assert -1.0 <= cls().step(set_point, depth, seconds) <= 1.0
