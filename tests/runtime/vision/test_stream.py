"""The camera's stream: its rate, its size, its quality, and the turning of pictures."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.vision_settings import Turn
from robot_runtime.vision.camera import CameraError, CameraFrame
from robot_runtime.vision.shape import before_turn, turn
from robot_runtime.vision.stream_quality import BYTES_MAX, ROOM_SECONDS, STEPS, StreamQuality
from robot_runtime.vision.video_device import describe_other
from tests.runtime.vision.harness import ShakyCamera, drawn
from tests.runtime.vision.test_node import VisionListener


class FifteenHzCamera(ShakyCamera):
    """A camera that gives 15 pictures a second and keeps what nobody takes."""

    rate = 15.0
    skipped = 0

    def skip(self) -> None:
        """Count."""
        if self.failure is not None:
            raise self.failure
        self.skipped += 1


def run(listener: VisionListener, clock: SimulatedClock, camera: ShakyCamera, seconds: float) -> int:
    """Run a node; return the pictures of its stream."""
    node = listener.node(clock, camera.open)
    end = clock.now() + seconds
    while clock.now() < end:
        clock.forward(node.tick())
    return sum(topic == "camera" for topic, _, _ in listener.pictures)


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(20.0)


@pytest.fixture
def listener() -> VisionListener:
    return VisionListener()


def test_a_watched_stream_has_its_rate_and_the_search_keeps_its_own(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    listener.watching = {"camera"}
    assert run(listener, clock, ShakyCamera(drawn(1.0, "yellow"), clock), 10.0) in range(149, 152)
    assert len(listener.detections) in range(39, 42)
    (_, taken, jpeg), *_ = listener.pictures
    assert taken == 20.0
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (480, 640, 3)


def test_a_stream_that_nobody_watches_is_not_made(listener: VisionListener, clock: SimulatedClock) -> None:
    camera = FifteenHzCamera(drawn(1.0, "yellow"), clock)
    assert run(listener, clock, camera, 10.0) == 0
    # The device's pictures are taken all the same, so that the searched ones are new.
    assert camera.skipped + len(listener.detections) in range(149, 154)
    assert len(listener.detections) in range(39, 42)


def test_a_device_that_gives_nothing_more_is_reported(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    camera = FifteenHzCamera(drawn(1.0, "yellow"), clock)
    node = listener.node(clock, camera.open)
    node.process_picture()
    camera.failure = CameraError("the plug is out")
    node.process_picture(search=False)
    assert node.text == "no picture: the plug is out"


@pytest.mark.parametrize("degrees", [0, 90, 180, 270])
def test_a_picture_is_turned_and_mirrored_before_the_search(
    degrees: Turn, listener: VisionListener, clock: SimulatedClock
) -> None:
    asked: list[tuple[int, int]] = []

    class Sideways(ShakyCamera):
        def read(self) -> CameraFrame:
            asked.append(self.size)
            return super().read()

    width, height = before_turn((320, 240), degrees)
    picture = np.full((height, width, 3), (150, 128, 30), np.uint8)
    # What is at the upper left of the robot's world, as the turned and mirrored camera sees it.
    back: Turn = {0: 0, 90: 270, 180: 180, 270: 90}[degrees]  # type: ignore[assignment]
    upright = np.full((240, 320, 3), (150, 128, 30), np.uint8)
    upright[20:100, 20:120] = (0, 220, 240)
    picture = turn(np.ascontiguousarray(upright[:, ::-1]), back, mirror=False)
    node = listener.node(clock, Sideways(picture, clock).open)
    node.settings = replace(node.settings, turn=degrees, mirror=True, opening=0.0)
    node.process_picture()
    (detection,) = listener.detections
    assert asked == [(width, height)]
    assert detection.box is not None
    assert (detection.box.x, detection.box.y) == pytest.approx((20 / 320, 20 / 240), abs=0.01)


def test_quality_falls_before_the_rate_and_rises_with_room() -> None:
    quality = StreamQuality(10.0)
    for now in range(100):
        quality.take(0.1 * now, 0.09, 20_000)
    assert quality.step == STEPS[0]
    for now in range(100, 200):
        quality.take(0.1 * now, 0.12, 20_000)
    assert quality.step == STEPS[-1]
    for now in range(200, 200 + int(10 * ROOM_SECONDS * 3 * len(STEPS))):
        quality.take(0.1 * now, 0.02, 20_000)
    assert quality.step == STEPS[0]


def test_a_large_picture_costs_quality_at_once() -> None:
    quality = StreamQuality(10.0)
    quality.take(0.0, 0.01, BYTES_MAX + 1)
    assert quality.step == STEPS[1]


def test_a_single_late_picture_costs_nothing() -> None:
    quality = StreamQuality(10.0)
    quality.take(0.0, 16.0, 20_000)
    assert quality.step == STEPS[0]


def test_the_stream_has_the_shape_of_the_searched_picture() -> None:
    assert VisionConfig(width=320, height=180).stream_size == (640, 360)


@pytest.mark.parametrize(
    ("own", "expected"),
    [
        (0x04200001, ""),
        (0x04A00000, "the metadata of the device 'HD Camera'"),
        (0x04200002, "another part of the device 'HD Camera'"),
    ],
    ids=["camera", "metadata", "output"],
)
def test_a_video_device_that_is_no_camera_is_named(own: int, expected: str) -> None:
    capability = b"uvcvideo".ljust(16, b"\0") + b"HD Camera".ljust(32, b"\0") + b"usb".ljust(32, b"\0")
    numbers = b"".join(number.to_bytes(4, "little") for number in (0x060100, 0x84A00001, own))
    assert describe_other(capability + numbers + bytes(12)) == expected
