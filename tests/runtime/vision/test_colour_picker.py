"""Picking a colour in the picture: on cards, at any hue, and without a colour."""

import json
from base64 import b64decode

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import COLOURS, ColourRange
from robot_runtime.errors import RefusedError
from robot_runtime.vision.camera import CameraError
from robot_runtime.vision.colour_picker import PickPoint, propose, range_of
from robot_runtime.vision.interface import VisionOutputs
from robot_runtime.vision.node import VisionNode
from robot_runtime.vision.patches import find_colour
from robot_runtime.vision.picture import Picture
from tests.runtime.vision.harness import ShakyCamera, drawn, find

MIDDLE = PickPoint(x=0.5, y=0.5)


def circle(low: int, span: int) -> list[int]:
    return [(low + step) % 180 for step in range(span + 1)]


@given(st.integers(0, 179), st.integers(0, 30), st.integers(60, 255), st.integers(40, 255))
def test_a_picked_range_contains_its_pixels_at_any_hue(
    low: int, span: int, saturation: int, value: int
) -> None:
    pixels = np.array([(hue, saturation, value) for hue in circle(low, span)], np.uint8)
    result = range_of(pixels)
    assert find_colour(pixels[np.newaxis], result).all()
    # The range exceeds the picked hues by no more than its margins, rounding included.
    held = (result.hue[1] - result.hue[0]) % 180
    assert held <= span + 2 * 5 + 2


@given(st.integers(0, 179), st.lists(st.integers(-8, 8), min_size=20, max_size=60), st.integers(0, 179))
def test_picking_is_invariant_to_a_shift_of_hue(middle: int, beside: list[int], turn: int) -> None:
    def picked(start: int) -> ColourRange:
        hues = [(start + offset) % 180 for offset in beside]
        return range_of(np.array([(hue, 200, 200) for hue in hues], np.uint8))

    straight, turned = picked(middle), picked(middle + turn)
    # A hue may fall to either side where rounding decides.
    for before, after in zip(straight.hue, turned.hue, strict=True):
        assert (after - before - turn + 1) % 180 <= 2
    assert straight.saturation == turned.saturation


@pytest.mark.parametrize("card", sorted(COLOURS))
def test_a_picked_range_finds_its_card_and_no_water(card: str) -> None:
    proposal = propose(drawn(3.0, card), MIDDLE)
    assert proposal.share == pytest.approx(0.26 * 0.36 * 3 / 4, rel=0.15)
    picked = {"picked": proposal.colour}
    for time in (3.0, 20.0, 777.7):
        assert find(drawn(time, card), "picked", colours=picked) is not None
        assert find(drawn(time, None), "picked", colours=picked) is None


@pytest.mark.parametrize("card", sorted(COLOURS))
def test_a_range_picked_in_the_brightest_light_is_valid_in_any_light(card: str) -> None:
    brightest = max(
        (drawn(0.5 * step, card) for step in range(200)), key=lambda picture: picture[116:125, 156:165].sum()
    )
    picked = propose(brightest, MIDDLE).colour
    for time in range(0, 100, 4):
        result = find(drawn(time, card), "picked", colours={"picked": picked})
        assert result is not None
        assert result.area == pytest.approx(0.26 * 0.36 * 3 / 4, rel=0.1)
        assert find(drawn(time, None), "picked", colours={"picked": picked}) is None


def one_colour(blue: int, green: int, red: int) -> Picture:
    return np.full((120, 160, 3), (blue, green, red), np.uint8)


@pytest.mark.parametrize(
    ("picture", "why"),
    [
        (one_colour(128, 128, 128), "it is grey"),
        (one_colour(140, 128, 120), "it is grey"),
        (one_colour(255, 255, 255), "it is grey"),
        (one_colour(0, 0, 0), "it is too dark"),
        (one_colour(25, 2, 2), "it is too dark"),
    ],
)
def test_pixels_without_colour_are_not_picked(picture: Picture, why: str) -> None:
    with pytest.raises(RefusedError, match=f"no colour at this place: {why}.*nothing was changed"):
        propose(picture, MIDDLE)


def test_several_colours_are_not_picked_as_one() -> None:
    picture = one_colour(20, 20, 220)
    picture[:, 80:] = (20, 220, 20)
    with pytest.raises(RefusedError, match="several colours"):
        propose(picture, PickPoint(x=0.5, y=0.5, radius=0.1))
    assert propose(picture, PickPoint(x=0.2, y=0.5)).share == pytest.approx(0.5)


@pytest.mark.parametrize("corner", [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
def test_the_edges_of_the_picture_can_be_picked(corner: tuple[float, float]) -> None:
    proposal = propose(one_colour(20, 220, 220), PickPoint(x=corner[0], y=corner[1]))
    assert proposal.share == 1.0


def test_some_glare_and_noise_do_not_widen_it() -> None:
    picture = one_colour(20, 200, 220)
    clean = propose(picture, MIDDLE).colour
    picture[60, 78:82] = 255
    assert propose(picture, MIDDLE).colour == clean


class TestNode:
    def vision(self, picture: Picture, clock: SimulatedClock) -> tuple[VisionNode, ShakyCamera]:
        camera = ShakyCamera(picture, clock)
        config = VisionConfig()
        outputs = VisionOutputs(detection=lambda _: None, event=lambda _: None)
        node = VisionNode(config, clock, outputs, camera.open)
        return node, camera

    def test_picks_in_the_newest_picture_and_changes_nothing(self) -> None:
        clock = SimulatedClock(1.0)
        node, _ = self.vision(drawn(1.0, "blue"), clock)
        node.process_picture()
        before = node.settings
        colour = json.loads(json.dumps(node.pick({"x": 0.5, "y": 0.5})))["colour"]
        assert find(drawn(1.0, "blue"), "picked", colours={"picked": parse(ColourRange, colour)}) is not None
        assert node.settings is before

    def test_the_mask_that_the_picked_colour_would_have_comes_with_it(self) -> None:
        node, _ = self.vision(drawn(1.0, "blue"), SimulatedClock(1.0))
        node.process_picture()
        answer = node.pick({"x": 0.5, "y": 0.5})
        jpeg = np.frombuffer(b64decode(answer["mask"]), np.uint8)
        mask = cv2.imdecode(jpeg, cv2.IMREAD_GRAYSCALE)
        assert mask is not None
        # The target is yellow: what is bright counts as the colour that was picked. JPEG blurs its edge.
        assert (mask > 180).mean() == pytest.approx(answer["share"], rel=0.1)

    def test_without_a_picture_the_reason_is_given(self) -> None:
        clock = SimulatedClock(1.0)
        node, camera = self.vision(drawn(1.0, "blue"), clock)
        with pytest.raises(RefusedError, match=r"no picture to pick a colour in\. Camera: starting"):
            node.pick({"x": 0.5, "y": 0.5})
        node.process_picture()
        camera.failure = CameraError("the lens cap is on")
        node.process_picture()
        with pytest.raises(RefusedError, match="the lens cap is on"):
            node.pick({"x": 0.5, "y": 0.5})

    @pytest.mark.parametrize(
        ("question", "why"),
        [
            ({"x": 0.5}, "y is missing"),
            ({"x": 1.5, "y": 0.5}, "between 0 and 1"),
            ({"x": float("nan"), "y": 0.5}, "must be a number"),
            ({"x": "left", "y": 0.5}, "must be a number"),
            ({"x": 0.5, "y": 0.5, "radius": 0.5}, "between 0.005 and 0.2"),
            ({"x": 0.5, "y": 0.5, "colour": "red"}, "not known"),
        ],
    )
    def test_bad_places_are_refused(self, question: dict[str, object], why: str) -> None:
        node, _ = self.vision(drawn(1.0, "blue"), SimulatedClock(1.0))
        node.process_picture()
        with pytest.raises(ConfigError, match=why):
            node.pick(question)
