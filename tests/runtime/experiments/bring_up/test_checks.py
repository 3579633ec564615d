"""The bring-up's judgement of readings: of a gyroscope at rest, and of a pressure sensor in air."""

from collections.abc import Callable
from math import radians

import pytest

from robot_runtime.contract.packets import Raw
from robot_runtime.experiments.bring_up.checks import check_air, check_rest
from robot_runtime.experiments.bring_up.readings import Three

STEP = radians(500) / 32768
"""rad/s, for one count: noise that any sound gyroscope has."""


def readings(rate: Callable[[int], Three], pressure: int = 101_325) -> list[Raw]:
    return [
        Raw(
            time=50_000 * number,
            encoders=(0, 0, 0, 0),
            rate=rate(number),
            force=(0.0, 0.0, 9.81),
            pressure=pressure,
            temperature=20.0,
            battery=780,
            identity=0x68,
            beacons=0,
            leak=0,
        )
        for number in range(40)
    ]


def test_a_hull_at_rest_gives_its_offset() -> None:
    result, offset = check_rest(readings(lambda number: (0.2, -0.1, STEP * (number % 2))))
    assert result.verdict == "good"
    assert offset == pytest.approx((0.2, -0.1, STEP / 2))


@pytest.mark.parametrize(
    ("rate", "advice"),
    [
        # Slower than any shaking, it is only seen where both halves are compared.
        (lambda number: (0.0, 0.0006 * number, 0.0), "The hull moved"),
        (lambda number: (0.1 * (number % 2), 0.0, 0.0), "The hull moved"),
        (lambda number: (0.8 + STEP * (number % 2), 0.0, 0.0), "off by so much"),
        (lambda _: (0.0, 0.0, 0.0), "do not change at all"),
    ],
)
def test_what_does_not_lie_still_is_refused_in_words(rate: Callable[[int], Three], advice: str) -> None:
    result, offset = check_rest(readings(rate))
    assert offset is None
    assert result.verdict == "wrong"
    assert advice in result.advice


@pytest.mark.parametrize(
    ("pressure", "advice"),
    [
        (101_325, ""),
        (112_000, "off by 50 hPa at most"),
        (20 * 101_325, "It counts as an MS5837-02BA does"),
        (0, "The sensor says nothing"),
    ],
)
def test_a_pressure_sensor_of_another_kind_is_named(pressure: int, advice: str) -> None:
    result = check_air(readings(lambda _: (0.0, 0.0, 0.0), pressure), 101_300.0)
    assert result.verdict == ("wrong" if advice else "good")
    assert advice in result.advice
