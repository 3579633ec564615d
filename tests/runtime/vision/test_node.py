"""The vision node: its detections, their times, and its recovery from failing cameras."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
import pytest

from robot_runtime.clock import Clock, SimulatedClock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.documents import Detection, Event
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.errors import RefusedError
from robot_runtime.vision.camera import Camera, CameraError
from robot_runtime.vision.interface import VisionOutputs
from robot_runtime.vision.node import RETRY, VisionNode
from robot_runtime.vision.picture import Picture
from tests.runtime.vision.harness import ShakyCamera, drawn


@dataclass
class VisionListener:
    """Stores the node's publications."""

    watching: set[str] = field(default_factory=set)
    detections: list[Detection] = field(default_factory=list)
    pictures: list[tuple[str, float, bytes]] = field(default_factory=list)
    thumbnails: list[tuple[float, bytes]] = field(default_factory=list)
    snapshots: list[tuple[float, bytes]] = field(default_factory=list)
    film: list[tuple[float, bytes]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)

    def node(
        self, clock: Clock, camera: Callable[[], Camera] | None = None, config: VisionConfig | None = None
    ) -> VisionNode:
        return VisionNode(config or VisionConfig(), clock, self.outputs, camera)

    @property
    def outputs(self) -> VisionOutputs:
        return VisionOutputs(
            detection=self.detections.append,
            event=self.events.append,
            picture=lambda topic, time, jpeg: self.pictures.append((topic.name, time, jpeg)),
            thumbnail=lambda time, jpeg: self.thumbnails.append((time, jpeg)),
            snapshot=lambda time, jpeg: self.snapshots.append((time, jpeg)),
            film=lambda time, picture: self.film.append((time, picture)),
            watched=lambda topic: topic.name in self.watching,
        )


@pytest.fixture
def listener() -> VisionListener:
    return VisionListener()


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(20.0)


def test_each_picture_gives_a_detection(listener: VisionListener, clock: SimulatedClock) -> None:
    node = listener.node(clock)
    for card in (None, "yellow", "red", None):
        node.show_card(card)
        node.process_picture()
        clock.forward(0.25)
    assert [detection.colour for detection in listener.detections] == [None, "yellow", "red", None]
    assert [detection.taken for detection in listener.detections] == [20.0, 20.25, 20.5, 20.75]
    nothing, yellow = listener.detections[:2]
    assert (nothing.box, nothing.area) == (None, 0.0)
    assert yellow.box is not None
    assert yellow.area > 0.05


def test_measures_its_own_time(listener: VisionListener, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = SimulatedClock(20.0)
    node = listener.node(clock)
    convert = cv2.cvtColor

    def slow(*arguments: object) -> object:
        clock.forward(0.03)
        return convert(*arguments)  # type: ignore[call-overload]

    monkeypatch.setattr(cv2, "cvtColor", slow)
    node.process_picture()
    assert listener.detections[0].processing == pytest.approx(0.03)
    assert listener.detections[0].time == pytest.approx(20.03)


def test_the_target_colour_comes_first(listener: VisionListener, clock: SimulatedClock) -> None:
    picture = drawn(1.0, "red")
    picture[:60, :60] = (0, 220, 240)
    node = listener.node(clock, ShakyCamera(picture, clock).open)
    for colour in ("yellow", "red", "green"):
        node.settings = VisionSettings(colour=colour)
        node.process_picture()
    assert [detection.colour for detection in listener.detections] == ["yellow", "red", "red"]


def test_pictures_are_encoded_only_for_subscribers(listener: VisionListener, clock: SimulatedClock) -> None:
    node = listener.node(clock)
    node.process_picture()
    assert listener.pictures == []
    listener.watching = {"picture"}
    node.show_card("yellow")
    node.process_picture()
    listener.watching = set()
    node.process_picture()
    ((topic, taken, jpeg),) = listener.pictures
    assert (topic, taken) == ("picture", 20.0)
    decoded = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert decoded is not None
    # The drawn picture, but for the losses of JPEG: without overlays.
    difference = np.abs(decoded.astype(float) - drawn(20.0, "yellow"))
    assert difference.mean() < 5


def test_a_snapshot_is_the_newest_picture_at_full_size(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    node = listener.node(clock)
    with pytest.raises(RefusedError, match=r"no picture to take\. Camera: starting"):
        node.take_snapshot()
    node.show_card("yellow")
    node.process_picture()
    assert node.take_snapshot() == {"time": 20.0}
    ((taken, jpeg),) = listener.snapshots
    decoded = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert decoded is not None
    assert (taken, decoded.shape) == (20.0, drawn(20.0, "yellow").shape)
    assert np.abs(decoded.astype(float) - drawn(20.0, "yellow")).mean() < 4
    with pytest.raises(RefusedError, match="is a snapshot already"):
        node.take_snapshot()
    clock.forward(5.0)
    with pytest.raises(RefusedError, match="newest picture is 5 s old"):
        node.take_snapshot()
    assert len(listener.snapshots) == 1


def test_mask_and_balanced_picture_are_encoded_for_subscribers(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    node = listener.node(clock)
    node.show_card("yellow")
    listener.watching = {"mask"}
    node.process_picture()
    listener.watching = {"balanced"}
    node.settings = VisionSettings(white_balance="grey_world")
    node.process_picture()
    assert [topic for topic, _, _ in listener.pictures] == ["mask", "balanced"]
    mask, balanced = (
        cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR) for _, _, jpeg in listener.pictures
    )
    assert mask is not None
    assert (mask > 200).all(axis=2).mean() == pytest.approx(0.26 * 0.36 * 3 / 4, rel=0.15)
    assert balanced is not None
    blue, _, red = balanced.reshape(-1, 3).mean(axis=0)
    assert blue / red < 1.3


def test_settings_change_as_a_whole_between_two_pictures(
    listener: VisionListener, clock: SimulatedClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    picture = drawn(1.0, "red")
    picture[:60, :60] = (0, 220, 240)
    node = listener.node(clock, ShakyCamera(picture, clock).open)
    at_once = (1, 1)
    node.settings = VisionSettings(confirmation=at_once)
    other = VisionSettings(colour="red", actions={"red": 2.0, "yellow": 3.0}, confirmation=at_once)
    convert = cv2.cvtColor

    def change_meanwhile(*arguments: object) -> object:
        node.settings = other
        return convert(*arguments)  # type: ignore[call-overload]

    monkeypatch.setattr(cv2, "cvtColor", change_meanwhile)
    node.process_picture()
    node.process_picture()
    before, after = listener.detections
    assert (before.colour, before.target, before.set_point) == ("yellow", "yellow", None)
    assert (after.colour, after.target, after.set_point) == ("red", "red", 2.0)


def test_a_camera_that_fails_is_reported_once_and_tried_again(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    camera = ShakyCamera(drawn(1.0, "yellow"), clock)
    node = listener.node(clock, camera.open)
    node.process_picture()
    assert node.text == "shaky camera"
    camera.failure = CameraError("the lens cap is on; take it off")
    for _ in range(20):
        clock.forward(0.25)
        node.process_picture()
    assert node.text == "no picture: the lens cap is on; take it off"
    assert [event.severity for event in listener.events] == ["caution"]
    assert "the lens cap is on; take it off" in listener.events[0].text
    # Opened at the start, then every two seconds.
    assert camera.opened == 1 + int(20 * 0.25 / RETRY)
    assert camera.closed == 1
    camera.failure = None
    clock.forward(RETRY)
    node.process_picture()
    assert [event.severity for event in listener.events] == ["caution", "info"]
    assert node.text == "shaky camera"
    assert [detection.colour for detection in listener.detections] == ["yellow", "yellow"]


def test_another_failure_is_reported_anew(listener: VisionListener, clock: SimulatedClock) -> None:
    camera = ShakyCamera(drawn(1.0, None), clock)
    node = listener.node(clock, camera.open)
    for text in ("no light", "no light", "no power"):
        camera.failure = CameraError(text)
        node.process_picture()
        clock.forward(RETRY)
    assert len(listener.events) == 2


def test_any_exception_of_a_camera_is_reported(
    listener: VisionListener, clock: SimulatedClock, caplog: pytest.LogCaptureFixture
) -> None:
    camera = ShakyCamera(drawn(1.0, None), clock)
    camera.failure = ZeroDivisionError("oops")
    node = listener.node(clock, camera.open)
    node.process_picture()
    assert "oops" in node.text
    assert "ZeroDivisionError" in caplog.text
    camera.failure = None
    clock.forward(RETRY)
    node.process_picture()
    assert len(listener.detections) == 1


def test_missing_file_and_its_return(tmp_path: Path, listener: VisionListener, clock: SimulatedClock) -> None:
    file = tmp_path / "pool.png"
    node = listener.node(clock, config=VisionConfig(camera="file", file=str(file)))
    node.process_picture()
    assert "there is no file" in node.text
    cv2.imwrite(str(file), drawn(1.0, "yellow"))
    clock.forward(RETRY)
    node.process_picture()
    assert node.text == "file pool.png"
    assert listener.detections[0].colour == "yellow"


def test_pi_camera_where_there_is_none(listener: VisionListener, clock: SimulatedClock) -> None:
    node = listener.node(clock, config=VisionConfig(camera="pi"))
    node.process_picture()
    assert "picamera2" in node.text
    assert listener.detections == []


def test_cards_are_refused_where_they_cannot_be_shown(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    node = listener.node(clock)
    with pytest.raises(
        RefusedError, match="no card of colour 'pink'; there are red, yellow, green, blue, marker 7"
    ):
        node.show_card("pink")
    assert node.card is None
    other = listener.node(clock, config=VisionConfig(camera="file", file="a.mp4"))
    with pytest.raises(RefusedError, match="the camera is 'file'"):
        other.show_card("red")


def test_pictures_are_taken_at_the_rate(listener: VisionListener, clock: SimulatedClock) -> None:
    node = listener.node(clock, config=VisionConfig(rate=20.0))
    while len(listener.detections) < 11:
        clock.forward(node.tick())
    gaps = {round(after.taken - before.taken, 6) for before, after in pairwise(listener.detections)}
    assert gaps == {0.05}


def test_a_higher_rate_applies_at_once(listener: VisionListener, clock: SimulatedClock) -> None:
    node = listener.node(clock, config=VisionConfig(rate=2.0))
    assert node.tick() == 0.0
    assert node.tick() == pytest.approx(0.5)
    node.settings = replace(node.settings, rate=20.0)
    assert node.tick() == pytest.approx(0.05)


def test_close_gives_the_camera_back(listener: VisionListener, clock: SimulatedClock) -> None:
    camera = ShakyCamera(drawn(1.0, None), clock)
    node = listener.node(clock, camera.open)
    node.tick()
    node.close()
    assert camera.closed == 1


def test_close_before_start(listener: VisionListener, clock: SimulatedClock) -> None:
    listener.node(clock).close()
    assert listener.detections == []


def test_survives_a_receiver_that_fails(clock: SimulatedClock, caplog: pytest.LogCaptureFixture) -> None:
    def fail(_: Detection) -> None:
        raise RuntimeError("nobody wants to know")

    node = VisionNode(VisionConfig(), clock, VisionOutputs(detection=fail, event=lambda _: None))
    assert node.tick() == 0.0
    assert "nobody wants to know" in caplog.text


@pytest.mark.parametrize("problem", [MemoryError("no room"), cv2.error("(-4:Insufficient memory)")])
def test_exhausted_memory_is_no_failure_of_the_camera(
    listener: VisionListener, clock: SimulatedClock, problem: Exception
) -> None:
    if isinstance(problem, cv2.error):
        problem.code = -4
    camera = ShakyCamera(drawn(1.0, None), clock)
    camera.failure = problem
    with pytest.raises(MemoryError):
        listener.node(clock, camera.open).tick()
    assert listener.events == []


def test_a_thumbnail_is_sent_every_two_seconds_without_subscribers(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    node = listener.node(clock)
    for _ in range(20):
        node.process_picture()
        clock.forward(0.25)
    assert [time for time, _ in listener.thumbnails] == [20.0, 22.0, 24.0]
    picture = cv2.imdecode(np.frombuffer(listener.thumbnails[0][1], np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (120, 160, 3)
    assert listener.pictures == []


def test_without_opencv_the_camera_says_so_and_all_else_goes_on(
    listener: VisionListener, clock: SimulatedClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "robot_runtime.vision.pipeline", None)
    node = listener.node(clock)
    node.start()
    node.close()
    assert node.text.startswith("no picture: NumPy and OpenCV cannot be loaded")
    assert "sudo apt install python3-opencv" in node.text
    assert [event.kind for event in listener.events] == ["camera"]
    with pytest.raises(RefusedError, match="OpenCV cannot be loaded"):
        node.show_card("yellow")
    with pytest.raises(RefusedError, match="OpenCV cannot be loaded"):
        node.pick({"time": 1.0, "x": 0.5, "y": 0.5})


def test_a_camera_with_a_rate_of_its_own_is_opened_again_for_another(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    camera = ShakyCamera(drawn(1.0, None), clock)
    camera.rate = 4.0
    node = listener.node(clock, camera.open)
    node.process_picture()
    node.process_picture()
    assert (camera.opened, camera.closed) == (1, 0)
    node.settings = replace(node.settings, rate=node.settings.rate + 20.0)
    node.process_picture()
    assert (camera.opened, camera.closed) == (2, 1)


YELLOW, NOTHING, RED = drawn(1.0, "yellow"), drawn(1.0, None), drawn(1.0, "red")


@pytest.fixture
def camera(clock: SimulatedClock) -> ShakyCamera:
    return ShakyCamera(NOTHING, clock)


def see(node: VisionNode, camera: ShakyCamera, clock: SimulatedClock, *pictures: Picture) -> None:
    """Show these pictures, four a second."""
    for picture in pictures:
        camera.picture = picture
        node.process_picture()
        clock.forward(0.25)


def test_one_false_picture_shows_nothing(
    listener: VisionListener, clock: SimulatedClock, camera: ShakyCamera
) -> None:
    node = listener.node(clock, camera.open, VisionConfig(actions={"yellow": 2.0, "red": 3.0}))
    see(node, camera, clock, NOTHING, YELLOW, NOTHING, RED, NOTHING, YELLOW, NOTHING)
    assert "yellow" in [detection.colour for detection in listener.detections]
    assert {(detection.target, detection.set_point) for detection in listener.detections} == {(None, None)}
    assert all(detection.confirmed == [] for detection in listener.detections)


class TestConfirmation:
    def test_one_false_picture_hides_nothing(
        self, listener: VisionListener, clock: SimulatedClock, camera: ShakyCamera
    ) -> None:
        node = listener.node(clock, camera.open, VisionConfig(actions={"yellow": 2.0}))
        see(node, camera, clock, YELLOW, YELLOW, NOTHING, YELLOW, YELLOW, RED, YELLOW)
        assert [detection.set_point for detection in listener.detections] == [None, *[2.0] * 6]

    def test_it_comes_and_goes_with_the_second_picture(
        self, listener: VisionListener, clock: SimulatedClock, camera: ShakyCamera
    ) -> None:
        node = listener.node(clock, camera.open)
        see(node, camera, clock, NOTHING, YELLOW, YELLOW, YELLOW, NOTHING, NOTHING, NOTHING)
        targets = [detection.target for detection in listener.detections]
        assert targets == [None, None, "yellow", "yellow", "yellow", None, None]

    def test_old_pictures_do_not_count(
        self, listener: VisionListener, clock: SimulatedClock, camera: ShakyCamera
    ) -> None:
        node = listener.node(clock, camera.open)
        see(node, camera, clock, YELLOW)
        clock.forward(5.0)
        see(node, camera, clock, YELLOW, YELLOW)
        assert [detection.target for detection in listener.detections] == [None, None, "yellow"]

    def test_other_numbers(
        self, listener: VisionListener, clock: SimulatedClock, camera: ShakyCamera
    ) -> None:
        node = listener.node(clock, camera.open, VisionConfig(confirmation=(3, 4)))
        see(node, camera, clock, *[YELLOW] * 4, NOTHING, YELLOW, NOTHING, NOTHING)
        targets = [detection.target for detection in listener.detections]
        assert targets == [None, None, *["yellow"] * 4, None, None]

    def test_a_change_of_settings_forgets_nothing(
        self, listener: VisionListener, clock: SimulatedClock, camera: ShakyCamera
    ) -> None:
        node = listener.node(clock, camera.open)
        see(node, camera, clock, YELLOW, YELLOW)
        node.settings = replace(node.settings, rate=8.0)
        see(node, camera, clock, YELLOW)
        assert [detection.target for detection in listener.detections] == [None, "yellow", "yellow"]


@pytest.mark.parametrize("kind", ["usb", "pi"])
def test_a_camera_that_repeats_one_picture_fails_until_another_one_comes(
    listener: VisionListener, clock: SimulatedClock, kind: Literal["usb", "pi"]
) -> None:
    camera = ShakyCamera(YELLOW, clock)
    node = listener.node(clock, camera.open, VisionConfig(camera=kind))
    for number in range(20):
        see(node, camera, clock, drawn(number / 4, "yellow"))
    assert listener.events == []
    frozen = YELLOW.copy()
    since = clock.now()
    while not listener.events:
        assert clock.now() - since < 10.0
        see(node, camera, clock, frozen.copy())
    assert 2.0 <= clock.now() - since <= 3.0
    assert node.text == "no picture: the camera repeats one picture: it hangs, or its lens is covered"
    searched = len(listener.detections)
    # Opened again it still hangs: neither an event nor a detection comes of it.
    for _ in range(40):
        see(node, camera, clock, frozen.copy())
    assert camera.opened >= 5
    assert (len(listener.events), len(listener.detections)) == (1, searched)
    for number in range(12):
        see(node, camera, clock, drawn(100 + number / 4, "yellow"))
    assert [event.severity for event in listener.events] == ["caution", "info"]
    assert node.text == "shaky camera"


class TestRepeatedPicture:
    """A real camera's pictures differ by its noise."""

    def test_a_change_of_one_byte_is_another_picture(
        self, listener: VisionListener, clock: SimulatedClock
    ) -> None:
        camera = ShakyCamera(YELLOW, clock)
        node = listener.node(clock, camera.open, VisionConfig(camera="usb"))
        for number in range(40):
            picture = YELLOW.copy()
            picture[1, 1, 1] = number
            see(node, camera, clock, picture)
        assert listener.events == []

    @pytest.mark.parametrize("kind", ["file", "card", "scene"])
    def test_files_and_simulated_cameras_may_repeat_theirs(
        self, listener: VisionListener, clock: SimulatedClock, kind: Literal["file", "card", "scene"]
    ) -> None:
        camera = ShakyCamera(YELLOW, clock)
        node = listener.node(clock, camera.open, VisionConfig(camera=kind))
        see(node, camera, clock, *[YELLOW] * 40)
        assert listener.events == []
        assert len(listener.detections) == 40
