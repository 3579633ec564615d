"""The settings: colour ranges, refusals, and the saved file."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.config import Config, load
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import COLOURS, ColourRange, VisionSettings
from robot_runtime.vision.patches import find_colour
from robot_runtime.vision.settings_file import VisionSettingsFile

WHOLE = (0, 255)
GOOD = {"hue": [20, 35], "saturation": [100, 255], "value": [70, 255]}


def every_hue() -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    """Return a picture one pixel high with each hue once."""
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


def colours(table: dict[str, object]) -> dict[str, ColourRange]:
    return parse(Config, {"vision": {"colour": next(iter(table)), "colours": table}}).vision.colours


def test_ranges_are_parsed() -> None:
    parsed = colours({"orange": {"hue": [8, 20], "saturation": [1, 2], "value": [3, 4]}})
    assert parsed == {"orange": ColourRange(hue=(8, 20), saturation=(1, 2), value=(3, 4))}


def test_robot_toml_shows_the_defaults() -> None:
    assert load(Path("robot.toml")).vision.settings == VisionSettings()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"hue": [20, 180]}, r"vision: colours.sky: hue\[1\] is 180; it must lie between 0 and 179"),
        ({"hue": [-1, 20]}, "between 0 and 179"),
        ({"hue": [20]}, "must be a list of 2 numbers"),
        ({"hue": [1, 2, 3]}, "must be a list of 2 numbers"),
        ({"hue": [1.5, 2]}, "a whole number"),
        ({"hue": [True, 2]}, "a whole number"),
        ({"saturation": [0, 256]}, "between 0 and 255"),
        ({"saturation": [200, 100]}, "saturation is .* only a hue range may run backwards"),
        ({"value": [70, 10]}, "value is .* only a hue range may run backwards"),
        ({"brightness": [0, 255]}, "'brightness' is not known here; known are hue, saturation, value"),
    ],
)
def test_impossible_ranges_are_refused(change: dict[str, list[int]], text: str) -> None:
    with pytest.raises(ConfigError, match=text):
        colours({"sky": {**GOOD, **change}})


def test_a_missing_range_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"vision: colours.sky: saturation is missing"):
        colours({"sky": {"hue": [1, 2]}})


@pytest.mark.parametrize(
    ("table", "text"),
    [
        ({"colour": "pink"}, "colour is 'pink'; it must be one of red, yellow, green, blue"),
        ({"colours": {}}, "there are 0 colours; there must be 1 to 16"),
        ({"colours": {"marker 3": GOOD}, "colour": "marker 3"}, "names a marker"),
        ({"colours": {"": GOOD}, "colour": ""}, "a name is a letter and up to 31"),
        ({"colours": {f"c{number}": GOOD for number in range(17)}, "colour": "c1"}, "there are 17 colours"),
        ({"rate": 31}, "between 2 and 30"),
        ({"rate": float("nan")}, "must be a number"),
        ({"area_min": 0.3, "area_max": 0.2}, "area_min is 0.3, above area_max"),
        ({"aspect": [3.0, 0.5]}, "cannot run backwards"),
        ({"fill_min": 1.5}, "between 0 and 1"),
        ({"white_balance": "magic"}, "one of 'none', 'grey_world', 'underwater'"),
        ({"markers": "4x4_51"}, "must be one of 'none', '4x4_50'"),
        ({"marker_numbers": [2000]}, "between 0 and 1023"),
        ({"marker_numbers": list(range(65))}, "at most 64"),
        ({"actions": {"pink": 1.0}}, "an action is for 'pink', which is no colour and no marker"),
        ({"actions": {"marker 3": 11}}, "between 0 and 10"),
        ({"actions": {"marker 03": 1}}, "no colour and no marker"),
    ],
)
def test_invalid_settings_are_refused(table: dict[str, object], text: str) -> None:
    with pytest.raises(ConfigError, match=text):
        parse(VisionSettings, table)


def test_the_range_that_the_thesis_prints_holds_nothing() -> None:
    numbers = {"hue": [120, 255], "saturation": [0, 255], "value": [70, 10]}
    with pytest.raises(ConfigError):
        colours({"thesis": numbers})
    everything = np.array(
        [[(h, s, v) for h in range(0, 180, 3)] for s in (0, 255) for v in range(256)], np.uint8
    )
    assert cv2.countNonZero(cv2.inRange(everything, (120, 0, 70), (255, 255, 10))) == 0


def test_saved_settings_are_read_again(tmp_path: Path) -> None:
    stored = VisionSettingsFile(tmp_path / "vision.json")
    assert stored.read() is None
    settings = VisionSettings(
        colour="Boje grün",
        colours={"Boje grün": COLOURS["green"]},
        aspect=(0.5, 2.0),
        markers="4x4_50",
        marker_numbers=(3, 7),
        actions={"marker 7": 1.5},
    )
    stored.write(settings)
    assert stored.read() == settings
    stored.forget()
    assert stored.read() is None


@pytest.mark.parametrize("text", ["", "[]", "{", '{"rate": 99}', '{"unknown": 1}', "\xff"])
def test_damaged_saved_settings_are_reported(tmp_path: Path, text: str) -> None:
    (tmp_path / "vision.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(ConfigError, match=r"vision\.json"):
        VisionSettingsFile(tmp_path / "vision.json").read()
