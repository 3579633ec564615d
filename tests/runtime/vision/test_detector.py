"""The search for a colour, in drawn water and in pictures of known patches."""

import cv2
import numpy as np
import pytest

from robot_runtime.vision.colours import DEFAULTS
from robot_runtime.vision.detector import Detector
from robot_runtime.vision.picture import Picture
from tests.runtime.vision.harness import drawn

TIMES = [0.0, 0.7, 3.0, 11.3, 60.0, 1000.2]
COLOURS = sorted(DEFAULTS)
YELLOW, RED, GREEN, GREY = (0, 220, 240), (20, 20, 220), (40, 180, 40), (90, 90, 90)


def patched(*patches: tuple[int, int, int, int, tuple[int, int, int]]) -> Picture:
    """A grey picture of 200 × 100 pixels with rectangles: x, y, width, height, colour."""
    picture = np.full((100, 200, 3), GREY, np.uint8)
    for x, y, width, height, colour in patches:
        cv2.rectangle(picture, (x, y), (x + width - 1, y + height - 1), colour, cv2.FILLED)
    return picture


def detector(area_min: float = 0.01) -> Detector:
    return Detector(DEFAULTS, area_min)


@pytest.mark.parametrize("size", [(320, 240), (640, 480)])
@pytest.mark.parametrize("card", COLOURS)
def test_each_card_is_found_as_its_own_colour(card: str, size: tuple[int, int]) -> None:
    for time in TIMES:
        picture = drawn(time, card, *size)
        patch = detector().find(picture, card)
        assert patch is not None
        assert patch.colour == card
        assert patch.area == pytest.approx(0.26 * 0.36 * size[1] / size[0], rel=0.1)
        assert abs(patch.box.x + patch.box.width / 2 - 0.5) < 0.05
        assert abs(patch.box.y + patch.box.height / 2 - 0.5) < 0.05


@pytest.mark.parametrize("wanted", COLOURS)
@pytest.mark.parametrize("card", COLOURS)
def test_no_card_is_taken_for_another_colour(card: str, wanted: str) -> None:
    for time in TIMES:
        patch = Detector(DEFAULTS, area_min=0.0005).find(drawn(time, card), wanted)
        assert patch is not None
        assert patch.colour == card


@pytest.mark.parametrize("wanted", COLOURS)
def test_plain_water_has_no_colour(wanted: str) -> None:
    for index in range(100):
        assert Detector(DEFAULTS, area_min=0.0005).find(drawn(index * 0.77, None), wanted) is None


def test_box_and_area_are_shares_of_the_picture() -> None:
    patch = detector().find(patched((40, 25, 60, 30, YELLOW)), "yellow")
    assert patch is not None
    assert (patch.box.x, patch.box.y) == (0.2, 0.25)
    assert (patch.box.width, patch.box.height) == (0.3, 0.3)
    # The contour runs through the middle of the outermost pixels.
    assert patch.area == pytest.approx(59 * 29 / 20000)


def test_largest_patch_of_the_wanted_colour_counts() -> None:
    picture = patched((10, 10, 20, 20, YELLOW), (100, 10, 30, 30, YELLOW), (150, 60, 25, 25, YELLOW))
    patch = detector().find(picture, "yellow")
    assert patch is not None
    assert patch.box.x == 0.5


def test_wanted_colour_goes_before_a_larger_one() -> None:
    picture = patched((10, 10, 80, 80, RED), (120, 10, 20, 20, YELLOW))
    found = {wanted: detector().find(picture, wanted) for wanted in COLOURS}
    assert {wanted: patch.colour if patch else None for wanted, patch in found.items()} == {
        "yellow": "yellow",
        "red": "red",
        "green": "red",
        "blue": "red",
    }


@pytest.mark.parametrize(("area_min", "seen"), [(0.04, True), (0.05, False)])
def test_patches_below_the_least_area_do_not_count(area_min: float, seen: bool) -> None:
    picture = patched((40, 25, 31, 31, YELLOW))
    assert (detector(area_min).find(picture, "yellow") is not None) is seen


def test_many_small_patches_do_not_make_a_large_one() -> None:
    picture = patched(*((x, y, 6, 6, YELLOW) for x in range(0, 200, 12) for y in range(0, 100, 12)))
    assert detector(0.01).find(picture, "yellow") is None


def test_lines_of_specks_do_not_widen_a_patch() -> None:
    picture = patched((60, 40, 20, 20, YELLOW), (0, 50, 200, 1, YELLOW))
    patch = detector().find(picture, "yellow")
    assert patch is not None
    assert (patch.box.x, patch.box.width) == (0.3, 0.1)


def test_red_is_found_on_both_sides_of_hue_zero() -> None:
    for hue in (172, 179, 0, 8):
        pixel = np.full((100, 200, 3), (hue, 220, 200), np.uint8)
        patch = detector().find(cv2.cvtColor(pixel, cv2.COLOR_HSV2BGR).astype(np.uint8), "red")
        assert patch is not None
        assert patch.colour == "red"


def test_one_coloured_pictures() -> None:
    full = detector().find(patched((0, 0, 200, 100, GREEN)), "green")
    assert full is not None
    assert (full.box.x, full.box.y, full.box.width, full.box.height) == (0, 0, 1, 1)
    assert detector().find(patched(), "green") is None
