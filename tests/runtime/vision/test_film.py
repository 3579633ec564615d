"""The film of the camera: its rate, its coding, its end, and the computer without PyAV."""

import sys

import cv2
import numpy as np
import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.commands import FilmCommand
from robot_runtime.contract.film_picture import FilmPicture
from robot_runtime.vision.camera import CameraFrame
from robot_runtime.vision.film import open_coder
from tests.film import HEIGHT, WIDTH, code_numbers, draw_number
from tests.runtime.vision.harness import ShakyCamera, drawn
from tests.runtime.vision.test_node import VisionListener

START = 20.0


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(START)


@pytest.fixture
def listener() -> VisionListener:
    return VisionListener()


class SlowCamera(ShakyCamera):
    """A camera that has a new picture every half second."""

    def read(self) -> CameraFrame:
        return CameraFrame(self.picture, self.clock.now() // 0.5 * 0.5)


def film(
    listener: VisionListener, clock: SimulatedClock, command: FilmCommand, seconds: float
) -> list[FilmPicture]:
    """Have a node film; return the pictures."""
    node = listener.node(clock, ShakyCamera(drawn(1.0, "yellow"), clock).open)
    node.film(command)
    end = clock.now() + seconds
    while clock.now() < end:
        clock.forward(node.tick())
    return [FilmPicture(picture) for _, picture in listener.film]


def test_a_film_has_its_rate_and_a_key_picture_every_second(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    pictures = film(listener, clock, FilmCommand(seconds=60.0), 10.0)
    assert len(pictures) in range(149, 152)
    keys = [time for (time, _), picture in zip(listener.film, pictures, strict=True) if picture.is_key]
    assert np.diff(keys) == pytest.approx(1.0, abs=0.07)
    assert keys[0] == START
    # The search keeps its own rate, and nothing else is sent.
    assert len(listener.detections) in range(39, 42)
    assert listener.pictures == []


def test_a_film_ends_where_nobody_asks_for_more(listener: VisionListener, clock: SimulatedClock) -> None:
    film(listener, clock, FilmCommand(seconds=2.0, rate=5.0), 10.0)
    times = [time for time, _ in listener.film]
    assert len(times) in range(9, 12)
    assert max(times) < START + 2.0


def test_a_film_that_begins_again_begins_with_a_key_picture(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    node = listener.node(clock, ShakyCamera(drawn(1.0, None), clock).open)
    for _ in range(2):
        node.film(FilmCommand(seconds=0.5))
        end = clock.now() + 0.7
        while clock.now() < end:
            clock.forward(node.tick())
    begins = [FilmPicture(picture).is_key for _, picture in listener.film]
    assert begins[0]
    assert sum(begins) == 2


def test_a_picture_that_the_camera_gives_twice_is_filmed_once(
    listener: VisionListener, clock: SimulatedClock
) -> None:
    camera = SlowCamera(drawn(1.0, None), clock)
    node = listener.node(clock, camera.open)
    node.film(FilmCommand(seconds=60.0))
    while clock.now() < START + 5.0:
        clock.forward(node.tick())
    times = [time for time, _ in listener.film]
    assert times == sorted(set(times))
    assert len(times) in range(9, 12)


def test_each_picture_is_coded_at_once_and_says_how() -> None:
    (_, first), (_, second) = code_numbers(open_coder(15.0, "medium", (WIDTH, HEIGHT)), range(2), START)
    assert (FilmPicture(first).is_key, FilmPicture(second).is_key) == (True, False)
    assert FilmPicture(first).codec.startswith("avc1.42")
    assert FilmPicture(second).codec == ""


def test_quality_costs_bytes() -> None:
    noise = np.random.default_rng(1).integers(0, 255, (HEIGHT, WIDTH, 3), np.uint8)
    sizes = [
        len(open_coder(15.0, quality, (WIDTH, HEIGHT)).code(START, noise))
        for quality in ("low", "medium", "high")
    ]
    assert sizes == sorted(set(sizes))


def test_without_pyav_the_film_is_jpeg_files(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "robot_runtime.vision.h264", raising=False)
    monkeypatch.setitem(sys.modules, "av", None)
    picture = FilmPicture(open_coder(15.0, "medium", (WIDTH, HEIGHT)).code(START, draw_number(7)))
    assert (picture.is_jpeg, picture.is_key, picture.codec) == (True, True, "mjpeg")
    decoded = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR)
    assert decoded is not None
    assert decoded.shape == (HEIGHT, WIDTH, 3)


@pytest.mark.parametrize("junk", [b"", b"\0\0\1", b"\0" * 40, b"\xff", b"\0\0\1\x67"])
def test_what_is_no_picture_is_no_key(junk: bytes) -> None:
    assert not FilmPicture(junk).is_key
    assert FilmPicture(junk).codec == ""
