"""The judgement of the fin check, from set points and angles of four fins."""

import re
from collections.abc import Callable
from math import pi, sin

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.packets import Motor
from robot_runtime.control.fin_check import FINS, FinCheck

Fin = Callable[[float], float]
STROKE = 2 * pi * 1.3


def wrap(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi


def flap(direction: float, lag: float = 0.0, size: float = 0.4) -> Fin:
    return lambda time: wrap(direction + size * sin(STROKE * (time - lag)))


def judge(expected: Fin, angle: Fin) -> dict[str, str]:
    """Return the check of a fin; the other three follow."""
    check = FinCheck(SimulatedClock())
    sound = flap(0.0)
    for step in range(400):
        time = step * 0.02
        points = (sound(time), expected(time), sound(time), sound(time))
        angles = (sound(time), angle(time), sound(time), sound(time))
        check.see(Motor(time=step, wanted=points, angle=angles, drive=(0, 0, 0, 0)))
    return check.failed()


@pytest.mark.parametrize("direction", [0.0, 1.5, pi, -3.0])
@pytest.mark.parametrize("lag", [0.0, 0.03, 0.1])
def test_a_fin_that_lags_follows_in_every_direction(direction: float, lag: float) -> None:
    assert judge(flap(direction), flap(direction, lag)) == {}


DIRECTIONS = (0.0, pi / 2, -pi / 2, -3 * pi / 2, -pi)
"""rad; of the front right fin, as the axes of a check turn it, always the same way round."""
TURN = 8.0
"""rad/s."""


def turn(time: float) -> float:
    """Return the set point of a fin that flaps and is turned once round, in as long as a check takes."""
    direction = DIRECTIONS[0]
    for number, following in enumerate(DIRECTIONS[1:], start=1):
        way = following - DIRECTIONS[number - 1]
        share = min(max(TURN * (time - 1.6 * number) / abs(way), 0.0), 1.0)
        direction += share * way
    return flap(direction)(time)


@pytest.mark.parametrize("lag", [0.0, 0.05, 0.1])
def test_a_fin_that_is_turned_once_round_follows(lag: float) -> None:
    assert judge(turn, lambda time: turn(time - lag)) == {}


@pytest.mark.parametrize("position", range(-180, 180, 15))
def test_a_fin_that_rests_anywhere_is_named(position: int) -> None:
    ((name, text),) = judge(turn, lambda _: position * pi / 180).items()
    assert name == FINS[1]
    assert re.fullmatch(r"was off its set point by \d\.\d\d rad", text)


def test_a_fin_that_turns_round_the_other_way_is_named() -> None:
    assert judge(turn, lambda time: wrap(-turn(time))) == {FINS[1]: "turned against its set point"}


@pytest.mark.parametrize("direction", [0.0, pi])
def test_a_fin_that_turns_the_other_way_is_named(direction: float) -> None:
    result = judge(flap(direction), flap(direction, size=-0.4))
    assert result == {FINS[1]: "turned against its set point"}


@pytest.mark.parametrize(
    "angle",
    [
        pytest.param(flap(0.3, size=0.0), id="still"),
        pytest.param(flap(0.0, lag=0.25 / 1.3), id="a quarter late"),
        pytest.param(lambda time: wrap(12.6 * time), id="spinning"),
    ],
)
def test_a_fin_that_stands_still_or_turns_as_it_likes_is_named(angle: Fin) -> None:
    ((name, text),) = judge(flap(0.0), angle).items()
    assert name == FINS[1]
    assert re.fullmatch(r"was off its set point by \d\.\d\d rad", text)


def test_a_fin_that_was_not_commanded_is_named() -> None:
    assert judge(flap(0.0, size=0.05), flap(0.0, size=0.05)) == {FINS[1]: "was not moved"}
