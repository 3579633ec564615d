"""The Raspberry Pi's camera and its JPEG encoder, with stand-ins for picamera2 and its hardware."""

import sys
from io import BufferedIOBase
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

import cv2
import numpy as np
import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import VisionConfig
from robot_runtime.vision import pi_encoder
from robot_runtime.vision.camera import CameraError, SensorControls
from robot_runtime.vision.pi_camera import PiCamera
from robot_runtime.vision.picture import Picture
from tests.runtime.vision.harness import drawn
from tests.runtime.vision.test_node import VisionListener

FIXED = SensorControls(exposure=12.5, gain=4.0, colour_temperature=5500)
START, END = b"\xff\xd8", b"\xff\xd9"


class StandIn:
    """Stands in for picamera2.Picamera2, as far as PiCamera uses it."""

    made: "list[StandIn]"
    picture: Picture
    failure: Exception | None
    cameras: list[dict[str, Any]]
    stamp: int | None
    camera_controls: dict[str, tuple[Any, Any, Any]]

    def __init__(self) -> None:
        self.calls: list[Any] = []
        self.made.append(self)

    @classmethod
    def global_camera_info(cls) -> list[dict[str, Any]]:
        return cls.cameras

    def create_video_configuration(self, **parts: Any) -> dict[str, Any]:
        return parts

    def configure(self, configuration: dict[str, Any]) -> None:
        self.calls.append(configuration)

    def start(self) -> None:
        if self.failure:
            raise self.failure
        self.calls.append("start")

    def camera_configuration(self) -> dict[str, Any]:
        return {"main": {"size": (320, 240), "format": "RGB888", "stride": 960}}

    def capture_request(self) -> "StandIn":
        if self.failure:
            raise self.failure
        return self

    def make_array(self, name: str) -> Picture:
        self.calls.append(name)
        return self.picture

    def get_metadata(self) -> dict[str, Any]:
        return {} if self.stamp is None else {"SensorTimestamp": self.stamp}

    def release(self) -> None:
        self.calls.append("release")

    def close(self) -> None:
        self.calls.append("close")


@pytest.fixture
def library(monkeypatch: pytest.MonkeyPatch) -> type[StandIn]:
    class Fresh(StandIn):
        made: list[StandIn] = []  # noqa: RUF012 - one a test
        picture = drawn(1.0, "yellow")
        failure = None
        cameras: list[dict[str, Any]] = [{"Model": "imx219"}]  # noqa: RUF012 - one a test
        stamp = None
        # libcamera's, each with its least, greatest and usual value.
        camera_controls: dict[str, tuple[Any, Any, Any]] = {  # noqa: RUF012 - one a test
            "FrameDurationLimits": (33333, 120000, 33333),
            "ExposureTime": (1, 66666, 20000),
            "AnalogueGain": (1.0, 16.0, 1.0),
            "AwbEnable": (False, True, None),
            "ColourTemperature": (100, 100000, None),
        }

    module: Any = ModuleType("picamera2")
    module.Picamera2 = Fresh
    monkeypatch.setitem(sys.modules, "picamera2", module)
    return Fresh


class TestPiCamera:
    def test_pictures_come_from_the_library(self, library: type[StandIn]) -> None:
        camera = PiCamera(320, 240, 4.0, SimulatedClock(4.0))
        frame = camera.read()
        camera.close()
        assert np.array_equal(frame.picture, library.picture)
        assert frame.taken == 4.0
        configuration = {
            "main": {"size": (320, 240), "format": "RGB888"},
            "controls": {"FrameRate": 4.0},
            "buffer_count": 2,
        }
        assert library.made[0].calls == [configuration, "start", "main", "release", "close"]

    @pytest.mark.parametrize(
        ("stamp", "taken"),
        [(3_930_000_000, 3.93), (None, 4.0), (4_100_000_000, 4.0), (1_000_000_000, 4.0)],
        ids=["sensor", "none", "of the future", "old"],
    )
    def test_a_picture_has_the_time_of_the_sensor(
        self, library: type[StandIn], stamp: int | None, taken: float
    ) -> None:
        library.stamp = stamp
        assert PiCamera(320, 240, 4.0, SimulatedClock(4.0)).read().taken == pytest.approx(taken)

    def test_exposure_gain_and_white_are_fixed_in_libcamera_s_units(self, library: type[StandIn]) -> None:
        PiCamera(320, 240, 4.0, SimulatedClock(), FIXED)
        assert library.made[0].calls[0]["controls"] == {
            "FrameRate": 4.0,
            "ExposureTime": 12500,
            "AnalogueGain": 4.0,
            "AwbEnable": False,
            "ColourTemperature": 5500,
        }

    def test_a_control_that_libcamera_does_not_know_is_left_out_and_named(
        self, library: type[StandIn]
    ) -> None:
        del library.camera_controls["ColourTemperature"]
        camera = PiCamera(320, 240, 4.0, SimulatedClock(), FIXED)
        assert "ColourTemperature" not in library.made[0].calls[0]["controls"]
        assert str(camera) == "Pi camera (320 × 240; this libcamera does not know ColourTemperature)"

    def test_a_missing_library_is_reported_with_its_installation(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setitem(sys.modules, "picamera2", None)
        with pytest.raises(CameraError, match=r"needs picamera2, which cannot be loaded .*sudo apt install"):
            PiCamera(320, 240, 4.0, SimulatedClock())

    def test_a_library_for_another_numpy_is_reported(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        text = "numpy.dtype size changed, may indicate binary incompatibility"
        (tmp_path / "picamera2.py").write_text(f"raise ValueError({text!r})")
        monkeypatch.syspath_prepend(tmp_path)
        monkeypatch.delitem(sys.modules, "picamera2", raising=False)
        with pytest.raises(CameraError, match=r"another NumPy .*dtype size changed.*Raspberry Pi OS 13"):
            PiCamera(320, 240, 4.0, SimulatedClock())

    def test_a_missing_camera_is_reported(self, library: type[StandIn]) -> None:
        library.cameras = []
        with pytest.raises(CameraError, match=r"no camera is connected to the Pi: check its cable"):
            PiCamera(320, 240, 4.0, SimulatedClock())
        assert library.made == []

    @pytest.mark.parametrize(
        ("failure", "remedy"),
        [
            (RuntimeError("Failed to acquire camera: Device or resource busy"), "another program uses it"),
            (PermissionError(13, "Permission denied"), "group video"),
            (RuntimeError("Camera configuration failed"), "check its cable"),
        ],
    )
    def test_a_camera_that_does_not_start_is_closed_and_reported(
        self, library: type[StandIn], failure: Exception, remedy: str
    ) -> None:
        library.failure = failure
        with pytest.raises(CameraError, match=rf"does not start .*; .*{remedy}"):
            PiCamera(320, 240, 4.0, SimulatedClock())
        assert library.made[0].calls[-1] == "close"

    def test_a_disconnected_camera_is_reported(self, library: type[StandIn]) -> None:
        camera = PiCamera(320, 240, 4.0, SimulatedClock())
        library.failure = RuntimeError("timeout")
        with pytest.raises(CameraError, match=r"gives no picture \(timeout\)"):
            camera.read()


class EncoderStandIn:
    """Stands in for picamera2's MJPEGEncoder, as far as PiEncoder uses it; its files are numbered."""

    made: ClassVar[list["EncoderStandIn"]]
    failure: ClassVar[Exception | None]
    silent: ClassVar[bool]
    size: tuple[int, int]
    format: str
    stride: int
    framerate: float
    bitrate: int
    output: BufferedIOBase

    def __init__(self) -> None:
        if self.failure:
            raise self.failure
        self.calls: list[Any] = []
        self.made.append(self)

    def start(self) -> None:
        self.calls.append("start")

    def encode(self, stream: str, request: StandIn) -> None:
        assert request.calls[-1] == "main", "the request is released already"
        self.calls.append(stream)
        if not self.silent:
            self.output.write(b"%b%d%b" % (START, len(self.calls), END))

    def stop(self) -> None:
        self.calls.append("stop")


@pytest.fixture
def encoders(monkeypatch: pytest.MonkeyPatch) -> type[EncoderStandIn]:
    class FreshEncoder(EncoderStandIn):
        made: ClassVar[list[EncoderStandIn]] = []
        failure = None
        silent = False

    module: Any = ModuleType("picamera2.encoders.mjpeg_encoder")
    module.MJPEGEncoder = FreshEncoder
    outputs: Any = ModuleType("picamera2.outputs")
    outputs.FileOutput = lambda file: file
    monkeypatch.setitem(sys.modules, "picamera2.encoders.mjpeg_encoder", module)
    monkeypatch.setitem(sys.modules, "picamera2.outputs", outputs)
    return FreshEncoder


@pytest.mark.usefixtures("library")
class TestPiEncoder:
    CONFIG = VisionConfig(camera="pi", stream_width=320)

    def test_each_picture_has_the_file_of_the_hardware(
        self, library: type[StandIn], encoders: type[EncoderStandIn]
    ) -> None:
        camera = PiCamera(320, 240, 15.0, SimulatedClock())
        frames = [camera.read() for _ in range(2)]
        assert [frame.jpeg for frame in frames] == [START + b"2" + END, START + b"3" + END]
        assert np.array_equal(frames[0].picture, library.picture)
        assert str(camera) == "Pi camera (320 × 240 as JPEG)"
        camera.close()
        (encoder,) = encoders.made
        assert encoder.calls == ["start", "main", "main", "stop"]
        assert (encoder.size, encoder.format, encoder.stride, encoder.framerate) == (
            (320, 240),
            "RGB888",
            960,
            15.0,
        )
        # 9.6 kB a picture.
        assert encoder.bitrate == 320 * 240 * 15

    def test_a_picture_of_another_size_is_not_encoded(self, encoders: type[EncoderStandIn]) -> None:
        camera = PiCamera(320, 240, 15.0, SimulatedClock())
        camera.size = (160, 120)
        assert camera.read().jpeg is None
        assert encoders.made[0].calls == ["start"]

    def test_a_pi_without_the_hardware_gives_pictures_alone(self, encoders: type[EncoderStandIn]) -> None:
        encoders.failure = RuntimeError("Hardware MJPEG not available on this platform")
        camera = PiCamera(320, 240, 15.0, SimulatedClock())
        assert camera.read().jpeg is None
        assert str(camera) == "Pi camera (320 × 240)"
        camera.close()

    def test_an_encoder_that_gives_nothing_is_left(
        self, encoders: type[EncoderStandIn], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(pi_encoder, "ENCODE_SECONDS", 0.0)
        encoders.silent = True
        camera = PiCamera(320, 240, 15.0, SimulatedClock())
        assert [camera.read().jpeg for _ in range(2)] == [None, None]
        assert encoders.made[0].calls == ["start", "main", "stop"]
        assert str(camera) == "Pi camera (320 × 240)"

    @pytest.mark.usefixtures("encoders")
    def test_the_stream_is_the_hardware_s_and_a_snapshot_is_of_the_picture_itself(
        self,
        library: type[StandIn],
    ) -> None:
        clock, listener = SimulatedClock(20.0), VisionListener(watching={"camera"})
        node = listener.node(clock, lambda: PiCamera(320, 240, 15.0, clock), self.CONFIG)
        node.process_picture(search=True, stream=True)
        node.take_snapshot()
        assert [jpeg for _, _, jpeg in listener.pictures] == [START + b"2" + END]
        ((_, jpeg),) = listener.snapshots
        picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
        assert picture is not None
        assert picture.shape == library.picture.shape

    @pytest.mark.usefixtures("encoders")
    def test_a_camera_that_hangs_is_found_by_its_picture(self) -> None:
        # The hardware's files of one picture differ: it holds the rate of its bits.
        clock, listener = SimulatedClock(20.0), VisionListener(watching={"camera"})
        node = listener.node(clock, lambda: PiCamera(320, 240, 15.0, clock), self.CONFIG)
        for _ in range(40):
            node.process_picture(search=False, stream=True)
            clock.forward(1 / 15)
        assert node.text == "no picture: the camera repeats one picture: it hangs, or its lens is covered"
