"""The JPEG files of a USB camera: sent unchanged where that is right, decoded where a picture is needed."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import cv2
import numpy as np
import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.topics import Topic
from robot_runtime.vision.node import VisionNode
from robot_runtime.vision.stream_quality import BYTES_MAX
from robot_runtime.vision.usb_camera import UsbCamera
from tests.runtime.vision.harness import JpegDevice, drawn
from tests.runtime.vision.test_node import VisionListener

CONFIG = VisionConfig(camera="usb")


def encoded(time: float, quality: int = 90) -> bytes:
    """Return a camera's JPEG file of 640 × 480 pixels with a yellow card."""
    _, jpeg = cv2.imencode(".jpg", drawn(time, "yellow", 640, 480), [cv2.IMWRITE_JPEG_QUALITY, quality])
    return jpeg.tobytes()


FILES = [encoded(0.1 * number) for number in range(5)]


def without_codes(jpeg: bytes) -> bytes:
    """Return a JPEG file without its Huffman tables."""
    while (start := jpeg.find(b"\xff\xc4")) >= 0:
        length = int.from_bytes(jpeg[start + 2 : start + 4], "big")
        jpeg = jpeg[:start] + jpeg[start + 2 + length :]
    return jpeg


@pytest.fixture
def listener() -> VisionListener:
    return VisionListener(watching={"camera"})


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(20.0)


@pytest.fixture
def start(
    listener: VisionListener, clock: SimulatedClock, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., VisionNode]:
    """Return a function that starts a node whose USB camera is a stand-in.

    Sending one of its pictures takes `sending` seconds.
    """

    def send(topic: Topic[bytes], time: float, jpeg: bytes, seconds: float) -> None:
        listener.outputs.picture(topic, time, jpeg)
        clock.forward(seconds)

    def start(device: JpegDevice, config: VisionConfig = CONFIG, sending: float = 0.0) -> VisionNode:
        outputs = replace(listener.outputs, picture=partial(send, seconds=sending))
        monkeypatch.setattr("robot_runtime.vision.usb_camera.check_device", lambda _: None)
        monkeypatch.setattr(cv2, "VideoCapture", device)
        return VisionNode(config, clock, outputs, lambda: UsbCamera("", 640, 480, 15.0, clock))

    return start


@pytest.fixture
def decoded(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return a list that gets the size of each file that OpenCV decodes."""
    sizes: list[int] = []
    decode = cv2.imdecode

    def count(data: Any, kind: int) -> Any:
        sizes.append(data.size)
        return decode(data, kind)

    monkeypatch.setattr(cv2, "imdecode", count)
    return sizes


def stream_of(listener: VisionListener) -> list[bytes]:
    return [jpeg for topic, _, jpeg in listener.pictures if topic == "camera"]


def test_the_stream_gets_the_camera_s_files_and_the_search_alone_decodes(
    listener: VisionListener,
    clock: SimulatedClock,
    start: Callable[..., VisionNode],
    decoded: list[int],
) -> None:
    node = start(JpegDevice([jpeg + bytes(100) for jpeg in FILES]))
    while clock.now() < 25.0:
        clock.forward(node.tick())
    # Without what the driver leaves behind the file's end.
    assert set(stream_of(listener)) == set(FILES)
    assert len(stream_of(listener)) in range(74, 77)
    assert len(decoded) == len(listener.detections) in range(19, 22)
    assert {detection.colour for detection in listener.detections} == {"yellow"}
    assert node.text == "USB camera /dev/video0 (640 × 480 as JPEG)"


@pytest.mark.parametrize(
    ("settings", "config", "files"),
    [
        ({"turn": 180}, {}, FILES),
        ({"mirror": True}, {}, FILES),
        ({}, {"stream_width": 320}, FILES),
        ({}, {"width": 800, "height": 600}, FILES),
        ({}, {}, [without_codes(jpeg) for jpeg in FILES]),
        ({}, {}, [jpeg[:-2] + bytes(BYTES_MAX) + jpeg[-2:] for jpeg in FILES]),
    ],
    ids=["turned", "mirrored", "smaller", "search larger", "without codes", "too large"],
)
def test_a_file_that_is_not_the_stream_s_picture_is_made_anew(
    settings: dict[str, Any],
    config: dict[str, Any],
    files: list[bytes],
    listener: VisionListener,
    start: Callable[..., VisionNode],
) -> None:
    node = start(JpegDevice(files), replace(CONFIG, **config))
    node.settings = replace(node.settings, **settings)
    node.process_picture(search=False, stream=True)
    (jpeg,) = stream_of(listener)
    assert jpeg not in files
    assert b"\xff\xc4" in jpeg
    assert jpeg.endswith(b"\xff\xd9")
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    width = config.get("stream_width", 640)
    assert picture.shape == (width * 3 // 4, width, 3)


def test_a_lower_quality_is_made_anew(
    listener: VisionListener, clock: SimulatedClock, start: Callable[..., VisionNode]
) -> None:
    node = start(JpegDevice(FILES), sending=0.1)
    while clock.now() < 24.0:
        clock.forward(node.tick())
    assert stream_of(listener)[0] == FILES[0]
    assert len(stream_of(listener)[-1]) < len(FILES[0]) / 2


@pytest.mark.parametrize("code", ["YUYV", "MJPG"], ids=["another format", "MJPG in name alone"])
def test_what_is_no_jpeg_file_is_opencv_s_to_convert(
    code: str, listener: VisionListener, start: Callable[..., VisionNode]
) -> None:
    class RawDevice(JpegDevice):
        def read(self) -> tuple[bool, Any]:
            return True, drawn(1.0, "yellow", 640, 480) if self.converts else np.zeros((1, 9000), np.uint8)

    device = RawDevice([], code)
    node = start(device)
    node.process_picture(search=True, stream=True)
    assert device.converts
    assert [detection.colour for detection in listener.detections] == ["yellow"]
    assert len(stream_of(listener)) == 1
    assert node.text == "USB camera /dev/video0 (640 × 480)"


def test_a_file_that_is_cut_off_is_left_out(
    listener: VisionListener, start: Callable[..., VisionNode]
) -> None:
    node = start(JpegDevice([FILES[0][:-2], FILES[1]]))
    node.process_picture(search=True, stream=True)
    assert stream_of(listener) == [FILES[1]]


@pytest.mark.parametrize(
    "file", [FILES[0][:-2], b"\xff\xd8 and nothing more \xff\xd9"], ids=["cut off", "empty"]
)
def test_a_camera_of_damaged_files_alone_fails(file: bytes, start: Callable[..., VisionNode]) -> None:
    node = start(JpegDevice([file]))
    node.process_picture()
    assert node.text == (
        "no picture: the camera /dev/video0 gives damaged pictures; check its plug and cable"
    )


def test_a_repeated_file_is_a_repeated_picture(
    clock: SimulatedClock, start: Callable[..., VisionNode], decoded: list[int]
) -> None:
    node = start(JpegDevice(FILES[:1]))
    for _ in range(40):
        node.process_picture(search=False, stream=True)
        clock.forward(1 / 15)
    assert node.text == "no picture: the camera repeats one picture: it hangs, or its lens is covered"
    assert decoded == []


def test_a_snapshot_is_the_camera_s_file(listener: VisionListener, start: Callable[..., VisionNode]) -> None:
    node = start(JpegDevice(FILES))
    node.process_picture(search=False, stream=True)
    node.take_snapshot()
    assert [jpeg for _, jpeg in listener.snapshots] == FILES[:1]
