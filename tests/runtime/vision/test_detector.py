"""The search for a colour, in drawn water and in pictures of known patches."""

from typing import Any

import cv2
import numpy as np
import pytest

from robot_runtime.contract.vision_settings import COLOURS, MARKER_COUNTS, MarkerDictionary, VisionSettings
from robot_runtime.vision.balance import BALANCES, grey_world, underwater
from robot_runtime.vision.detector import DICTIONARIES, Detector, Sight, choose_target
from robot_runtime.vision.patches import COUNTED, DROPPED, GROUND, OUTLINE, OUTLINE_REFUSED, draw_mask
from robot_runtime.vision.picture import Picture
from tests.runtime.vision.harness import drawn, find

TIMES = [0.0, 0.7, 3.0, 11.3, 60.0, 1000.2]
NAMES = sorted(COLOURS)
YELLOW, RED, GREEN, GREY = (0, 220, 240), (20, 20, 220), (40, 180, 40), (90, 90, 90)


def patched(*patches: tuple[int, int, int, int, tuple[int, int, int]]) -> Picture:
    """Return a grey picture of 200 × 100 pixels with rectangles: x, y, width, height, colour."""
    picture = np.full((100, 200, 3), GREY, np.uint8)
    for x, y, width, height, colour in patches:
        cv2.rectangle(picture, (x, y), (x + width - 1, y + height - 1), colour, cv2.FILLED)
    return picture


@pytest.mark.parametrize("size", [(320, 240), (640, 480)])
@pytest.mark.parametrize("card", NAMES)
def test_each_card_is_found_as_its_own_colour(card: str, size: tuple[int, int]) -> None:
    for time in TIMES:
        picture = drawn(time, card, *size)
        patch = find(picture, card)
        assert patch is not None
        assert patch.colour == card
        assert patch.area == pytest.approx(0.26 * 0.36 * size[1] / size[0], rel=0.1)
        assert abs(patch.box.x + patch.box.width / 2 - 0.5) < 0.05
        assert abs(patch.box.y + patch.box.height / 2 - 0.5) < 0.05


@pytest.mark.parametrize("expected", NAMES)
@pytest.mark.parametrize("card", NAMES)
def test_no_card_is_taken_for_another_colour(card: str, expected: str) -> None:
    for time in TIMES:
        patch = find(drawn(time, card), expected, 0.0005)
        assert patch is not None
        assert patch.colour == card


@pytest.mark.parametrize("expected", NAMES)
def test_plain_water_has_no_colour(expected: str) -> None:
    for index in range(100):
        assert find(drawn(index * 0.77, None), expected, 0.0005) is None


def test_box_and_area_are_shares_of_the_picture() -> None:
    patch = find(patched((40, 25, 60, 30, YELLOW)), "yellow")
    assert patch is not None
    assert (patch.box.x, patch.box.y) == (0.2, 0.25)
    assert (patch.box.width, patch.box.height) == (0.3, 0.3)
    # The contour runs through the middle of the outermost pixels.
    assert patch.area == pytest.approx(59 * 29 / 20000)


def test_the_largest_patch_of_the_target_colour_counts() -> None:
    picture = patched((10, 10, 20, 20, YELLOW), (100, 10, 30, 30, YELLOW), (150, 60, 25, 25, YELLOW))
    patch = find(picture, "yellow")
    assert patch is not None
    assert patch.box.x == 0.5


def test_the_target_colour_has_priority_over_a_larger_patch() -> None:
    picture = patched((10, 10, 80, 80, RED), (120, 10, 20, 20, YELLOW))
    results = {expected: find(picture, expected) for expected in NAMES}
    assert {expected: patch.colour if patch else None for expected, patch in results.items()} == {
        "yellow": "yellow",
        "red": "red",
        "green": "red",
        "blue": "red",
    }


@pytest.mark.parametrize(("area_min", "seen"), [(0.04, True), (0.05, False)])
def test_patches_below_the_least_area_do_not_count(area_min: float, seen: bool) -> None:
    picture = patched((40, 25, 31, 31, YELLOW))
    assert (find(picture, "yellow", area_min) is not None) is seen


def test_many_small_patches_do_not_make_a_large_one() -> None:
    picture = patched(*((x, y, 6, 6, YELLOW) for x in range(0, 200, 12) for y in range(0, 100, 12)))
    assert find(picture, "yellow") is None


def test_lines_of_specks_do_not_widen_a_patch() -> None:
    picture = patched((60, 40, 20, 20, YELLOW), (0, 50, 200, 1, YELLOW))
    patch = find(picture, "yellow")
    assert patch is not None
    assert (patch.box.x, patch.box.width) == (0.3, 0.1)


def test_red_is_found_on_both_sides_of_hue_zero() -> None:
    for hue in (172, 179, 0, 8):
        pixel = np.full((100, 200, 3), (hue, 220, 200), np.uint8)
        patch = find(cv2.cvtColor(pixel, cv2.COLOR_HSV2BGR).astype(np.uint8), "red")
        assert patch is not None
        assert patch.colour == "red"


def test_one_coloured_pictures() -> None:
    full = find(patched((0, 0, 200, 100, GREEN)), "green")
    assert full is not None
    assert (full.box.x, full.box.y, full.box.width, full.box.height) == (0, 0, 1, 1)
    assert find(patched(), "green") is None


def look(picture: Picture, **settings: Any) -> Sight:
    return Detector(VisionSettings(**settings)).search(picture)


BAR, SQUARE = (10, 40, 100, 20, YELLOW), (130, 20, 40, 40, YELLOW)


@pytest.mark.parametrize(
    ("filters", "x", "reason"),
    [
        ({}, 0.05, None),
        ({"aspect": (0.5, 2.0)}, 0.65, "too wide"),
        ({"area_max": 0.09}, 0.65, "too large"),
        ({"circularity_min": 0.7}, 0.65, "not round enough"),
    ],
)
def test_filters_pass_patches_of_the_given_shape(
    filters: dict[str, Any], x: float, reason: str | None
) -> None:
    sight = look(patched(BAR, SQUARE), **filters)
    assert sight.patch is not None
    assert sight.patch.box.x == x
    refused = [candidate.refused for candidate in sight.target_patches.candidates if candidate.refused]
    assert refused == ([reason] if reason else [])


def test_a_cross_fills_less_of_its_box_than_a_square() -> None:
    cross = patched((50, 10, 20, 80, YELLOW), (20, 40, 80, 20, YELLOW))
    square = patched((20, 10, 80, 80, YELLOW))
    assert look(square, fill_min=0.95).patch is not None
    refused = look(cross, fill_min=0.95)
    assert refused.patch is None
    (candidate,) = refused.target_patches.candidates
    assert candidate.refused == "fills too little of its box"
    assert candidate.fill == pytest.approx((80 * 20 * 2 - 400) / 6400, abs=0.02)


def test_a_disc_is_round_and_a_square_is_less_so() -> None:
    picture = patched()
    cv2.circle(picture, (100, 50), 40, YELLOW, cv2.FILLED)
    (disc,) = look(picture).target_patches.candidates
    (square,) = look(patched((50, 10, 80, 80, YELLOW))).target_patches.candidates
    assert disc.circularity > 0.87
    assert square.circularity == pytest.approx(np.pi / 4, abs=0.01)
    assert (disc.aspect, square.aspect) == (1.0, 1.0)


def test_opening_removes_what_is_smaller_than_it() -> None:
    picture = patched((40, 20, 6, 60, YELLOW))
    assert look(picture, opening=0.0).patch is not None
    assert look(picture, opening=0.05).patch is None


def test_the_number_of_reported_candidates_is_limited() -> None:
    specks = patched(*((x, y, 8, 8, YELLOW) for x in range(0, 200, 14) for y in range(0, 100, 14)))
    assert len(look(specks).target_patches.candidates) == 5


def find_target(picture: Picture, **settings: Any) -> str | None:
    """Return the name that sets the set point where every picture shows this."""
    return choose_target(VisionSettings(**settings), look(picture, **settings).names)


def test_the_first_action_is_the_target() -> None:
    actions = {"green": 2.0, "red": 1.5, "marker 7": 3.0}
    both = patched((10, 10, 60, 60, RED), (120, 10, 30, 30, GREEN))
    # The first action counts, not the largest patch.
    assert look(both, actions=actions).colour == "green"
    assert find_target(both, actions=actions) == "green"
    assert find_target(patched((10, 10, 60, 60, RED)), actions=actions) == "red"
    # A colour without an action is reported, without an effect.
    assert look(patched((10, 10, 60, 60, RED)), actions={"green": 2.0}).colour == "red"
    assert find_target(patched((10, 10, 60, 60, RED)), actions={"green": 2.0}) is None


def test_the_target_colour_has_priority_over_every_action() -> None:
    both = patched((10, 10, 60, 60, RED), (120, 10, 30, 30, YELLOW))
    assert find_target(both, actions={"red": 1.5}) == "yellow"
    assert find_target(both, actions={"red": 1.5, "yellow": 2.5}) == "yellow"


def marked(number: int, dictionary: int = cv2.aruco.DICT_4X4_50) -> Picture:
    picture = np.full((240, 320, 3), 235, np.uint8)
    printed = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(dictionary), number, 96)
    picture[60:156, 80:176] = printed[..., np.newaxis]
    return picture


def test_a_marker_is_decoded_with_its_place() -> None:
    sight = look(marked(7), markers="4x4_50", actions={"marker 7": 3.0})
    (marker,) = sight.markers
    assert marker.number == 7
    expected = [80, 60, 175, 60, 175, 155, 80, 155]
    for at, (share, pixels) in enumerate(zip(marker.corners, expected, strict=True)):
        assert share * (240 if at % 2 else 320) == pytest.approx(pixels, abs=1.5)
    assert sight.patch is None
    assert find_target(marked(7), markers="4x4_50", actions={"marker 7": 3.0}) == "marker 7"


def test_markers_are_selected_by_dictionary_and_number() -> None:
    assert look(marked(7)).markers == []
    assert look(marked(7), markers="4x4_50", marker_numbers=(1, 8)).markers == []
    assert [marker.number for marker in look(marked(7), markers="4x4_50", marker_numbers=(7,)).markers] == [7]
    assert look(marked(7), markers="6x6_250").markers == []
    assert find_target(marked(7), markers="4x4_50", actions={"marker 8": 1.0}) is None


def test_the_counts_of_the_dictionaries_are_opencvs() -> None:
    counts = {
        name: len(cv2.aruco.getPredefinedDictionary(number).bytesList)
        for name, number in DICTIONARIES.items()
    }
    assert {"none": 0, **counts} == MARKER_COUNTS


@pytest.mark.parametrize("name", sorted(DICTIONARIES))
def test_every_dictionary_reads_its_own(name: MarkerDictionary) -> None:
    (marker,) = look(marked(3, DICTIONARIES[name]), markers=name).markers
    assert marker.number == 3


def test_the_drawn_card_carries_the_marker() -> None:
    for time in TIMES:
        (marker,) = look(drawn(time, "marker 7"), markers="4x4_50").markers
        assert marker.number == 7


class TestMask:
    def test_the_mask_shows_accepted_and_rejected_patches_with_outlines(self) -> None:
        sight = look(patched(SQUARE, BAR, (5, 5, 2, 2, YELLOW)), aspect=(0.5, 2.0))
        mask = draw_mask(sight.target_patches)
        assert mask.shape == (100, 200, 3)
        assert tuple(mask[40, 150]) == COUNTED
        assert tuple(mask[50, 60]) == tuple(mask[5, 5]) == DROPPED
        assert tuple(mask[80, 20]) == GROUND
        assert tuple(mask[20, 150]) == OUTLINE
        assert tuple(mask[40, 60]) == OUTLINE_REFUSED

    def test_the_mask_of_plain_water_is_empty(self) -> None:
        assert (draw_mask(look(patched()).target_patches) == GROUND).all()


class TestWhiteBalance:
    def test_none_is_the_picture_itself(self) -> None:
        picture = drawn(1.0, "red")
        assert look(picture).balanced is picture

    def test_grey_world_makes_the_means_equal(self) -> None:
        tinted = np.clip(drawn(1.0, "red").astype(float) * (0.5, 0.8, 1.0), 0, 255).astype(np.uint8)
        means = grey_world(tinted).reshape(-1, 3).mean(axis=0)
        assert np.ptp(means) < 0.1 * means.mean()

    def test_a_grey_picture_stays(self) -> None:
        grey = patched()
        for balance in BALANCES.values():
            assert np.abs(balance(grey).astype(int) - grey).max() <= 1

    def test_red_is_given_back_by_the_formula(self) -> None:
        picture = np.full((40, 40, 3), (160, 120, 40), np.uint8)
        red = 40 / 255 + (120 - 40) / 255 * (1 - 40 / 255) * 120 / 255
        # Then the grey world makes what is all of one colour grey.
        grey = (160 + 120 + 255 * red) / 3
        assert underwater(picture)[0, 0] == pytest.approx(np.full(3, grey), abs=2)

    def test_water_is_less_blue_afterwards(self) -> None:
        picture = drawn(1.0, None)
        for balance in (grey_world, underwater):
            blue, _, red = balance(picture).reshape(-1, 3).mean(axis=0)
            assert blue / red < 1.6 < 3 < picture[..., 0].mean() / picture[..., 2].mean()

    def test_black_and_one_channel_pictures_do_not_fail(self) -> None:
        for colour in ((0, 0, 0), (255, 0, 0), (0, 0, 255), (255, 255, 255)):
            picture = np.full((30, 40, 3), colour, np.uint8)
            for balance in BALANCES.values():
                assert balance(picture).shape == picture.shape
