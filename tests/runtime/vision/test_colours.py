"""Colour ranges: what they hold, and which are refused."""

import tomllib
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.config import ConfigError
from robot_runtime.vision.colours import DEFAULTS, ColourRange, parse_colours
from robot_runtime.vision.detector import find_colour

WHOLE = (0, 255)
GOOD = {"hue": [20, 35], "saturation": [100, 255], "value": [70, 255]}


def every_hue() -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    """A picture one pixel high that holds each hue once."""
    return np.array([[(hue, 200, 200) for hue in range(180)]], np.uint8)


@given(st.integers(0, 179), st.integers(0, 179))
def test_hue_range_holds_its_ends_and_what_lies_between_going_up(low: int, high: int) -> None:
    mask = find_colour(every_hue(), ColourRange(hue=(low, high), saturation=WHOLE, value=WHOLE))[0]
    expected = {(low + step) % 180 for step in range((high - low) % 180 + 1)}
    assert {hue for hue in range(180) if mask[hue]} == expected


@pytest.mark.parametrize(("hue", "middle"), [((20, 40), 30), ((170, 10), 0), ((160, 8), 174), ((5, 5), 5)])
def test_middle_of_a_range_that_may_run_through_zero(hue: tuple[int, int], middle: int) -> None:
    assert ColourRange(hue=hue, saturation=WHOLE, value=(100, 200)).middle == (middle, 127, 150)


@pytest.mark.parametrize(("part", "index"), [("saturation", 1), ("value", 2)])
def test_saturation_and_value_count_too(part: str, index: int) -> None:
    ranges = {"hue": (0, 179), "saturation": WHOLE, "value": WHOLE, part: (100, 150)}
    pixel = [90, 120, 120]
    for number, inside in ((99, False), (100, True), (150, True), (151, False)):
        pixel[index] = number
        assert bool(find_colour(np.array([[pixel]], np.uint8), ColourRange(**ranges))[0, 0]) is inside


def test_ranges_are_parsed() -> None:
    parsed = parse_colours({"orange": {"hue": [8, 20], "saturation": [1, 2], "value": [3, 4]}})
    assert parsed == {"orange": ColourRange(hue=(8, 20), saturation=(1, 2), value=(3, 4))}


def test_no_ranges_mean_the_defaults() -> None:
    assert parse_colours({}) == DEFAULTS


def test_robot_toml_shows_the_defaults() -> None:
    table = tomllib.loads(Path("robot.toml").read_text(encoding="utf-8"))
    assert parse_colours(table["vision"]["colours"]) == DEFAULTS


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"hue": [20, 180]}, r"vision.colours.sky: hue is \[20, 180\]; .* 0 to 179"),
        ({"hue": [-1, 20]}, "0 to 179"),
        ({"hue": [20]}, "two whole numbers"),
        ({"hue": [1, 2, 3]}, "two whole numbers"),
        ({"hue": [1.5, 2]}, "two whole numbers"),
        ({"hue": [True, 2]}, "two whole numbers"),
        ({"saturation": [0, 256]}, "0 to 255"),
        ({"saturation": [200, 100]}, "saturation is .* only a hue range may run backwards"),
        ({"value": [70, 10]}, "value is .* only a hue range may run backwards"),
        ({"brightness": [0, 255]}, "must have hue, saturation and value"),
    ],
)
def test_impossible_ranges_are_refused(change: dict[str, list[int]], text: str) -> None:
    with pytest.raises(ConfigError, match=text):
        parse_colours({"sky": {**GOOD, **change}})


def test_a_missing_range_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"vision.colours.sky has hue; it must have"):
        parse_colours({"sky": {"hue": [1, 2]}})


def test_the_range_that_the_thesis_prints_holds_nothing() -> None:
    numbers = {"hue": [120, 255], "saturation": [0, 255], "value": [70, 10]}
    with pytest.raises(ConfigError):
        parse_colours({"thesis": numbers})
    everything = np.array(
        [[(h, s, v) for h in range(0, 180, 3)] for s in (0, 255) for v in range(256)], np.uint8
    )
    assert cv2.countNonZero(cv2.inRange(everything, (120, 0, 70), (255, 255, 10))) == 0
