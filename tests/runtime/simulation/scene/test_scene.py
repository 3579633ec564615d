"""The rendered picture, by position and water."""

from dataclasses import asdict, replace
from itertools import product

import numpy as np
import pytest

from robot_runtime.contract.card_colours import MARKER_CARD, PAINTS, WHITE
from robot_runtime.contract.documents import Truth
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.simulation.scene import model as modelling
from robot_runtime.simulation.scene.contents import START_TARGETS, Contents, SceneWater, Target
from robot_runtime.simulation.scene.view import ObserverView
from robot_runtime.simulation.scene.water import Kind
from robot_runtime.simulation.water.surroundings import Basin
from robot_runtime.vision.detector import Detector
from tests.runtime.simulation.scene.conftest import Make
from tests.runtime.simulation.scene.harness import centre, changed, open_water, truth
from tests.runtime.vision.harness import find

SIZE = (320, 240)
NOSE = 0.125
AHEAD = Target(colour="yellow", position=(2.0, 0.0, 5.0), size=0.2)


def test_a_target_straight_ahead_is_in_the_middle(scene: Make) -> None:
    empty = scene(open_water()).render_camera(1.0, truth(), *SIZE)
    picture = scene(open_water(AHEAD)).render_camera(1.0, truth(), *SIZE)
    assert centre(changed(picture, empty)) == pytest.approx((0.5, 0.5), abs=0.01)


@pytest.mark.parametrize(
    ("turn", "where"),
    [
        # Pitch and yaw (°), and where the target goes: up and right are the picture's own.
        ((0.0, -10.0), (0.5 + np.tan(np.radians(10)) / np.tan(np.radians(24.4)) * 3 / 8, 0.5)),
        ((-10.0, 0.0), (0.5, 0.5 - np.tan(np.radians(10)) / np.tan(np.radians(24.4)) / 2)),
    ],
)
def test_it_moves_as_the_robot_turns(
    scene: Make, turn: tuple[float, float], where: tuple[float, float]
) -> None:
    # Far enough away that the camera, which is before the middle, hardly moves sideways.
    turned = truth(pitch=turn[0], yaw=turn[1])
    far = Target(colour="yellow", position=(4.0, 0.0, 5.0), size=0.4)
    empty = scene(open_water()).render_camera(1.0, turned, *SIZE)
    picture = scene(open_water(far)).render_camera(1.0, turned, *SIZE)
    assert centre(changed(picture, empty)) == pytest.approx(where, abs=0.02)


def test_what_is_to_the_right_sinks_as_the_robot_rolls_left(scene: Make) -> None:
    right = Target(colour="yellow", position=(2.0, 0.5, 5.0), size=0.2)
    level = scene(open_water(right)).render_camera(1.0, truth(), *SIZE)
    across, down = centre(changed(level, scene(open_water()).render_camera(1.0, truth(), *SIZE)))
    assert across > 0.65
    assert down == pytest.approx(0.5, abs=0.01)
    # Rolling left lifts the right side of the robot, and with it the picture's.
    rolled = truth(roll=-30.0)
    picture = scene(open_water(right)).render_camera(1.0, rolled, *SIZE)
    _, down = centre(changed(picture, scene(open_water()).render_camera(1.0, rolled, *SIZE)))
    assert down > 0.6


def test_its_size_follows_perspective(scene: Make) -> None:
    box = Target(colour="yellow", position=(1.0 + NOSE + 0.1, 0.0, 5.0), size=0.2)
    contents = open_water(box)
    mask = changed(
        scene(contents).render_camera(1.0, truth(), *SIZE),
        scene(open_water()).render_camera(1.0, truth(), *SIZE),
        least=90,
    )
    high = np.count_nonzero(mask.any(axis=1)) / SIZE[1]
    # A ball shows its outline a little nearer than its middle.
    assert high == pytest.approx(0.2 / (2 * 1.1 * np.tan(np.radians(24.4))), rel=0.05)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (
            "natural",
            {
                ("yellow", 0.5): "yellow",
                ("yellow", 3.4): "green",
                ("red", 1.0): "red",
                ("red", 3.0): None,
                ("blue", 3.0): "blue",
                ("green", 3.0): "green",
            },
        ),
        ("pool", {("yellow", 1.25): "yellow", ("yellow", 3.4): "green", ("red", 2.5): "red"}),
    ],
)
def test_colours_are_lost_with_distance(
    scene: Make, kind: Kind, expected: dict[tuple[str, float], str | None]
) -> None:
    depths = {colour: 5.0 * number for number, colour in enumerate(PAINTS, 1)}
    targets = [
        Target(colour=colour, position=(0.0, 0.0, depth), size=0.4) for colour, depth in depths.items()
    ]
    renderer = scene(open_water(*targets, kind=kind))
    for (colour, distance), seen in expected.items():
        pose = truth((-NOSE - distance - 0.2, 0.0, depths[colour]))
        patch = find(renderer.render_camera(1.0, pose, *SIZE), colour, 0.002)
        assert (patch and patch.colour) == seen, (colour, distance)


@pytest.mark.parametrize(
    "contents", [Contents(), Contents(basin=Basin(2.0, 6.0, 4.0))], ids=["natural", "pool"]
)
def test_a_card_is_detected_as_its_own_colour(scene: Make, contents: Contents) -> None:
    renderer = scene(contents)
    for colour, (time, depth) in product(PAINTS, ((1.0, 0.3), (7.0, 1.5))):
        picture = renderer.render_camera(time, truth((0.0, 0.0, depth)), *SIZE, PAINTS[colour])
        patch = find(picture, colour)
        assert patch is not None
        assert patch.colour == colour
        assert (patch.box.x + patch.box.width / 2, patch.box.y + patch.box.height / 2) == pytest.approx(
            (0.5, 0.5), abs=0.02
        )


@pytest.mark.parametrize("target", START_TARGETS, ids=lambda target: f"{target.colour} {target.shape}")
def test_from_the_start_each_target_is_called_by_its_own_colour(scene: Make, target: Target) -> None:
    renderer = scene(Contents(targets=(target,)))
    for depth in (0.05, 0.5, 1.0):
        result = find(renderer.render_camera(1.0, truth((0.0, 0.0, depth)), *SIZE), "yellow")
        assert result is None or result.colour == target.colour


@pytest.mark.parametrize("size", [(320, 240), (640, 480)])
def test_the_marker_card_is_decoded(scene: Make, size: tuple[int, int]) -> None:
    pose = truth((0.0, 0.0, 1.0), roll=10.0)
    picture = scene(Contents()).render_camera(1.0, pose, *size, WHITE, marked=True)
    (marker,) = Detector(VisionSettings(markers="4x4_50")).search(picture).markers
    assert marker.number == MARKER_CARD
    assert sum(marker.corners[0::2]) / 4 == pytest.approx(0.5, abs=0.02)
    assert sum(marker.corners[1::2]) / 4 == pytest.approx(0.5, abs=0.02)
    # Its first corner is the upper left one of the upright marker.
    assert marker.corners[0] < 0.5
    assert marker.corners[1] < 0.5


@pytest.mark.parametrize(
    "contents",
    [Contents(targets=()), Contents(basin=Basin(2.5, 12.0, 6.0), targets=())],
    ids=["natural", "pool"],
)
def test_the_surroundings_have_none_of_the_colours(scene: Make, contents: Contents) -> None:
    renderer = scene(contents)
    for number in range(20):
        rng = np.random.default_rng(number)
        north, east, depth = rng.uniform((-2.0, -2.0, 0.05), (2.0, 2.0, 2.4)).tolist()
        roll, pitch, yaw = rng.uniform((-20.0, -40.0, 0.0), (20.0, 40.0, 360.0)).tolist()
        pose = truth((north, east, depth), roll, pitch, yaw)
        assert find(renderer.render_camera(float(number), pose, *SIZE), "yellow") is None


def test_turbid_water_hides_everything(scene: Make) -> None:
    green = Target(colour="green", position=(2.0, 0.0, 5.0), size=0.2)
    clear, turbid = open_water(green, turbidity=0.1), open_water(green, turbidity=0.7)
    assert find(scene(clear).render_camera(1.0, truth(), *SIZE), "green", 0.002)
    assert not find(scene(turbid).render_camera(1.0, truth(), *SIZE), "green", 0.002)


def test_the_same_truth_gives_the_same_bytes(scene: Make) -> None:
    pose = truth((1.0, -0.5, 1.2), 5.0, -3.0, 20.0)
    item, other = scene(Contents()), scene(Contents())
    first = item.render_camera(3.0, pose, *SIZE)
    item.render_camera(4.0, truth((0.0, 0.0, 0.6)), *SIZE, PAINTS["red"])
    item.fill(Contents(water=SceneWater(kind="pool"), basin=Basin(2.0, 8.0, 5.0)))
    item.render_observer(4.0, pose, ObserverView(), *SIZE)
    item.fill(Contents())
    assert item.render_camera(3.0, pose, *SIZE).tobytes() == first.tobytes()
    assert other.render_camera(3.0, pose, *SIZE).tobytes() == first.tobytes()
    assert other.render_camera(3.05, pose, *SIZE).tobytes() != first.tobytes()


@pytest.mark.parametrize(
    "view",
    [
        ObserverView(),
        ObserverView(name="side", azimuth=90.0, elevation=0.0),
        ObserverView(name="top", azimuth=0.0, elevation=89.0, distance=1.2),
    ],
    ids=lambda view: view.name,
)
def test_a_bystander_sees_the_robot_and_its_camera_does_not(scene: Make, view: ObserverView) -> None:
    renderer = scene(open_water())
    pose = truth(yaw=50.0)
    patch = find(renderer.render_observer(1.0, pose, view, 640, 360), "yellow", 0.001)
    assert patch is not None
    assert patch.colour == "yellow"
    across, down = patch.box.x + patch.box.width / 2, patch.box.y + patch.box.height / 2
    assert (across, down) == pytest.approx((0.5, 0.5), abs=0.06)
    assert find(renderer.render_camera(1.0, pose, *SIZE), "yellow", 0.001) is None


def test_from_above_north_is_up_and_east_to_the_right(scene: Make) -> None:
    view = ObserverView(name="top", azimuth=0.0, elevation=89.0, distance=3.0)
    red = Target(colour="red", position=(0.5, 0.5, 5.0), size=0.3)
    patch = find(
        scene(open_water(red, kind="pool")).render_observer(1.0, truth(), view, 640, 360), "red", 0.001
    )
    assert patch is not None
    assert patch.colour == "red"
    assert patch.box.x > 0.5
    assert patch.box.y + patch.box.height < 0.5


def test_fins_move(scene: Make) -> None:
    renderer = scene(open_water())
    view = ObserverView(name="side", azimuth=90.0, elevation=10.0, distance=0.6)
    turned = Truth(**{**asdict(truth()), "fins": (0.0, 0.0, 0.0, 1.0)})
    before = renderer.render_observer(1.0, truth(), view, 640, 360)
    after = renderer.render_observer(1.0, turned, view, 640, 360)
    down, right = np.nonzero(changed(after, before))
    assert len(down) > 50
    # The front left fin of a robot that looks north is, seen from the west, to the left.
    assert right.mean() < 320


def test_two_beacons_may_have_one_place(scene: Make) -> None:
    made = scene(replace(open_water(), beacons=((2.0, 0.0, 5.0), (2.0, 0.0, 5.0))))
    picture = made.render_camera(0.0, truth(), *SIZE)
    made.fill(replace(open_water(), beacons=((2.0, 0.0, 5.0),)))
    assert (made.render_camera(0.0, truth(), *SIZE) == picture).all()


def test_contents_that_cannot_be_built_leave_the_scene_as_it_is(
    scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    contents = open_water(AHEAD)
    made = scene(contents)
    before = made.render_camera(0.0, truth(), *SIZE)

    def refuse(*_: object) -> None:
        raise ValueError("repeated name")

    with monkeypatch.context() as patch:
        patch.setattr(modelling, "build", refuse)
        with pytest.raises(ValueError, match="repeated name"):
            made.fill(open_water())
    assert made.contents == contents
    assert (made.render_camera(0.0, truth(), *SIZE) == before).all()
