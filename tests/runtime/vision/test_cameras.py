"""The cameras: drawn, from files, and of USB with a stand-in for its device."""

import errno
import os
import struct
import sys
from math import inf, nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.vision_settings import COLOURS, ColourRange, VisionSettings
from robot_runtime.vision import file_camera
from robot_runtime.vision.camera import NO_CONTROLS, Camera, CameraError, SensorControls
from robot_runtime.vision.card_camera import ATTENUATION, CARD_DISTANCE, NOISE, CardCamera
from robot_runtime.vision.cards import CameraCard, make_card
from robot_runtime.vision.detector import Detector
from robot_runtime.vision.file_camera import FileCamera
from robot_runtime.vision.picture import Picture
from robot_runtime.vision.usb_camera import UsbCamera
from tests.runtime.vision.harness import JpegDevice, VideoControls, drawn, find

FPS = 10.0
FIXED = SensorControls(exposure=12.5, gain=4.0, colour_temperature=5500)


class TestCardCamera:
    def test_same_time_same_picture(self) -> None:
        assert np.array_equal(drawn(3.25, "red"), drawn(3.25, "red"))

    def test_light_noise_and_card_move(self) -> None:
        assert not np.array_equal(drawn(3.25, None), drawn(3.5, None))
        boxes = {patch.box for time in range(10) if (patch := find(drawn(time, "red"), "red"))}
        assert len(boxes) > 5

    @pytest.mark.parametrize(("width", "height"), [(64, 48), (320, 240), (640, 480), (333, 101)])
    def test_pictures_have_the_configured_shape(self, width: int, height: int) -> None:
        picture = drawn(1.0, "blue", width, height)
        assert picture.shape == (height, width, 3)
        assert picture.dtype == np.uint8

    def test_noise_has_its_size_and_differs_from_picture_to_picture(self) -> None:
        early, late = (drawn(time, None)[100:140].astype(float) for time in (3.0, 3.001))
        # Light hardly changes within a millisecond: what differs is noise, twice.
        assert (late - early).std() == pytest.approx(NOISE * 2**0.5, rel=0.1)

    def test_water_grows_darker_downwards(self) -> None:
        picture = drawn(1.0, None).astype(float)
        assert picture[:40].mean() > 1.3 * picture[-40:].mean()

    def test_water_takes_red_from_a_card(self) -> None:
        white = CameraCard("white", (255, 255, 255))
        camera = CardCamera(320, 240, SimulatedClock(), lambda: white)
        blue, green, red = camera.draw(0.0, white)[110:130, 150:170].reshape(-1, 3).mean(axis=0)
        assert blue > green > red
        assert red / blue < 0.93
        assert ATTENUATION[2] * CARD_DISTANCE == pytest.approx(0.24)

    def test_each_picture_shows_the_present_time_and_card(self) -> None:
        clock, cards = SimulatedClock(5.0), ["red"]
        camera = CardCamera(320, 240, clock, lambda: make_card(cards[0], COLOURS))
        assert camera.read().taken == 5.0
        assert "red card" in str(camera)
        cards[0] = "blue"
        clock.forward(1.0)
        frame = camera.read()
        assert frame.taken == 6.0
        assert np.array_equal(frame.picture, drawn(6.0, "blue"))
        camera.close()

    def test_colours_without_a_paint_get_a_card_too(self) -> None:
        pink = {"pink": ColourRange(hue=(145, 165), saturation=(120, 255), value=(120, 255))}
        card = make_card("pink", pink)
        picture = CardCamera(320, 240, SimulatedClock(), lambda: card).draw(1.0, card)
        assert find(picture, "pink", colours=pink) is not None


@pytest.fixture(params=[("mjpg.avi", "MJPG"), ("mp4v.mp4", "mp4v")], ids=["avi", "mp4"])
def video(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    name, code = request.param
    return make_video(tmp_path / name, code)


def write_video(file: Path, pictures: list[Picture], code: str) -> Path:
    height, width = pictures[0].shape[:2]
    writer = cv2.VideoWriter(str(file), cv2.VideoWriter.fourcc(*code), FPS, (width, height))
    assert writer.isOpened()
    for picture in pictures:
        writer.write(picture)
    writer.release()
    return file


def make_video(file: Path, code: str = "MJPG") -> Path:
    """Twelve pictures, each brighter by 20 than the one before."""
    return write_video(file, [np.full((120, 160, 3), 20 * index, np.uint8) for index in range(12)], code)


def claim_rate(file: Path, rate: int) -> None:
    """Have an AVI claim so many pictures a second: scale and rate of its stream's header."""
    data = bytearray(file.read_bytes())
    header = data.index(b"strh") + 8
    data[header + 20 : header + 28] = struct.pack("<II", 1, rate)
    file.write_bytes(data)


def turn_film(file: Path, turn: int) -> None:
    """Note in an MP4 by how much it is to be turned clockwise (ISO 14496-12, the matrix of tkhd)."""
    data = bytearray(file.read_bytes())
    cosine, sine = {90: (0, 1), 180: (-1, 0), 270: (0, -1)}[turn]
    position = data.index(b"tkhd") + 4 + 40
    full = 1 << 16
    data[position : position + 36] = struct.pack(
        ">9i", *(cosine * full, sine * full, 0, -sine * full, cosine * full, 0, 0, 0, 1 << 30)
    )
    file.write_bytes(data)


def shown(camera: Camera) -> int:
    """Number of the video's picture that the camera returns now."""
    return round(float(camera.read().picture.mean()) / 20)


class TestFileCamera:
    def test_video_plays_at_its_own_speed_and_again(self, video: Path) -> None:
        clock = SimulatedClock(50.0)
        camera = FileCamera(video, 160, 120, clock)
        clock.forward(0.01)
        seen = []
        for _ in range(8):
            seen.append(shown(camera))
            clock.forward(0.31)
        assert seen[:4] == [0, 3, 6, 9]
        # From its end it begins again with the first picture.
        assert seen[4:] == [0, 3, 6, 9]
        camera.close()

    def test_a_video_read_faster_than_it_plays_shows_each_picture_for_its_time(self, video: Path) -> None:
        clock = SimulatedClock()
        camera = FileCamera(video, 160, 120, clock)
        clock.forward(0.001)
        seen = []
        for _ in range(9):
            seen.append(shown(camera))
            clock.forward(1 / 30)
        assert seen == [0, 0, 0, 1, 1, 1, 2, 2, 2]
        camera.close()

    def test_pictures_are_scaled(self, video: Path) -> None:
        camera = FileCamera(video, 320, 240, SimulatedClock(7.0))
        frame = camera.read()
        assert frame.picture.shape == (240, 320, 3)
        assert frame.taken == 7.0
        assert str(camera) == f"file {video.name} (160 × 120, scaled to 320 × 240)"
        camera.close()

    @pytest.mark.parametrize("rate", ["1000", "180000", "1e9"])
    def test_a_rate_that_no_camera_has_is_replaced_by_a_usual_one(self, tmp_path: Path, rate: str) -> None:
        file = make_video(tmp_path / "claims.avi")
        claim_rate(file, int(float(rate)))
        clock = SimulatedClock()
        camera = FileCamera(file, 160, 120, clock)
        assert "played at 25" in str(camera)
        clock.forward(0.001)
        seen = []
        for _ in range(4):
            seen.append(shown(camera))
            clock.forward(0.08)
        assert seen == [0, 2, 4, 6]
        camera.close()

    @pytest.mark.parametrize("rate", [nan, inf, 0.0, -1.0])
    def test_a_video_without_rate_and_times_is_played_at_a_usual_rate(
        self, video: Path, rate: float, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        class Timeless:
            def __init__(self, path: str) -> None:
                self._capture = cv2.VideoCapture(path)

            def get(self, property_: int) -> float:
                timed = property_ in (cv2.CAP_PROP_FPS, cv2.CAP_PROP_POS_MSEC)
                return rate if timed else self._capture.get(property_)

            def __getattr__(self, name: str) -> Any:
                return getattr(self._capture, name)

        monkeypatch.setattr(file_camera, "_capture", Timeless)
        clock = SimulatedClock()
        camera = FileCamera(video, 160, 120, clock)
        assert "played at 25" in str(camera)
        clock.forward(0.081)
        assert shown(camera) == 2
        camera.close()

    def test_uneven_times_are_those_of_the_pictures(self, tmp_path: Path) -> None:
        file = make_video(tmp_path / "uneven.webm", "VP80")
        times = [0, 100, 200, 1000, 1050, 1100, 3000, 3100, 3200, 3300, 3400, 3500]
        data = file.read_bytes()
        for index, time in reversed(list(enumerate(times))):
            # A SimpleBlock of Matroska: the track, 16 bits of ms, flags.
            old, new = (b"\x81" + value.to_bytes(2, "big") for value in (100 * index, time))
            position = data.rindex(old)
            data = data[:position] + new + data[position + len(old) :]
        file.write_bytes(data)
        clock = SimulatedClock()
        camera = FileCamera(file, 160, 120, clock)
        for passed, number in ((0.05, 0), (0.15, 1), (0.9, 2), (1.02, 3), (2.9, 5), (3.05, 6), (3.52, 11)):
            clock.forward(passed - clock.now())
            assert shown(camera) == number, passed
        camera.close()

    @pytest.mark.parametrize("shape", [(640, 360), (360, 640), (64, 48), (1000, 200)])
    @pytest.mark.parametrize("name", ["disc.png", "disc.avi"])
    def test_a_circle_stays_a_circle(self, tmp_path: Path, shape: tuple[int, int], name: str) -> None:
        picture = np.full((shape[1], shape[0], 3), (130, 110, 20), np.uint8)
        middle = (shape[0] // 2, shape[1] // 2)
        cv2.circle(picture, middle, min(shape) // 3, (30, 200, 225), cv2.FILLED)
        file = tmp_path / name
        if name.endswith(".png"):
            cv2.imwrite(str(file), picture)
        else:
            write_video(file, [picture] * 3, "MJPG")
        camera = FileCamera(file, 320, 240, SimulatedClock())
        sight = Detector(VisionSettings(colour="yellow", aspect=(0.95, 1.05))).search(camera.read().picture)
        assert sight.colour == "yellow"
        assert f"{shape[0]} × {shape[1]}" in str(camera)
        camera.close()

    @pytest.mark.parametrize("turn", [90, 180, 270])
    def test_a_film_of_a_phone_that_was_held_otherwise_is_upright(self, tmp_path: Path, turn: int) -> None:
        # Red in the upper left corner as it lies in the file.
        picture = np.zeros((120, 160, 3), np.uint8)
        picture[:40, :40] = (0, 0, 255)
        file = write_video(tmp_path / "phone.mp4", [picture] * 4, "mp4v")
        turn_film(file, turn)
        camera = FileCamera(file, 160, 120, SimulatedClock())
        red = camera.read().picture[..., 2] > 150
        down, across = (float(indices.mean()) for indices in np.nonzero(red))
        right, below = {90: (True, False), 180: (True, True), 270: (False, True)}[turn]
        assert (across > 80, down > 60) == (right, below)
        camera.close()

    @pytest.mark.parametrize("kind", ["grey", "grey 16 bit", "16 bit", "alpha", "one pixel"])
    def test_pictures_of_every_kind_have_three_bytes_a_pixel(self, tmp_path: Path, kind: str) -> None:
        pixel: dict[str, NDArray[Any]] = {
            "grey": np.full((6, 8), 200, np.uint8),
            "grey 16 bit": np.full((6, 8), 200 * 257, np.uint16),
            "16 bit": np.full((6, 8, 3), 200 * 257, np.uint16),
            "alpha": np.full((6, 8, 4), 200, np.uint8),
            "one pixel": np.full((1, 1, 3), 200, np.uint8),
        }
        file = tmp_path / "picture.png"
        cv2.imwrite(str(file), pixel[kind])
        picture = FileCamera(file, 32, 24, SimulatedClock()).read().picture
        assert (picture.shape, picture.dtype) == ((24, 32, 3), np.uint8)
        assert (picture == 200).all()

    @pytest.mark.parametrize("name", ["card.png", "card.jpg", "card 01.bmp"])
    def test_a_still_picture_stays_the_same(self, tmp_path: Path, name: str) -> None:
        file = tmp_path / name
        assert cv2.imwrite(str(file), drawn(1.0, "yellow"))
        clock = SimulatedClock()
        camera = FileCamera(file, 320, 240, clock)
        for _ in range(3):
            patch = find(camera.read().picture, "yellow")
            assert patch is not None
            assert patch.colour == "yellow"
            clock.forward(10)
        camera.close()

    def test_a_missing_file_is_reported(self, tmp_path: Path) -> None:
        with pytest.raises(CameraError, match=r"there is no file .*gone.mp4.*robot.toml"):
            FileCamera(tmp_path / "gone.mp4", 320, 240, SimulatedClock())

    def test_a_missing_file_name_is_reported(self) -> None:
        with pytest.raises(CameraError, match="name a video or a picture"):
            FileCamera(Path(), 320, 240, SimulatedClock())

    @pytest.mark.parametrize("name", ["broken.mp4", "broken.png"])
    def test_a_file_that_is_no_picture_is_reported(self, tmp_path: Path, name: str) -> None:
        file = tmp_path / name
        file.write_bytes(b"this is no picture" * 50)
        with pytest.raises(
            CameraError, match=f"{name} (is neither a video nor a|holds no) picture that OpenCV can"
        ):
            FileCamera(file, 320, 240, SimulatedClock()).read()


@pytest.fixture
def device(tmp_path: Path) -> str:
    (tmp_path / "video9").touch()
    return str(tmp_path / "video9")


class TestUsbControls:
    CONTROLS = (
        cv2.CAP_PROP_AUTO_EXPOSURE,
        cv2.CAP_PROP_EXPOSURE,
        cv2.CAP_PROP_GAIN,
        cv2.CAP_PROP_AUTO_WB,
        cv2.CAP_PROP_WB_TEMPERATURE,
    )

    def opened(
        self, monkeypatch: pytest.MonkeyPatch, device: str, capture: VideoControls, controls: SensorControls
    ) -> tuple[str, dict[int, float]]:
        """Return the text of a camera, and the values of its controls."""
        monkeypatch.setattr(cv2, "VideoCapture", capture)
        camera = UsbCamera(device, 320, 240, 4.0, SimulatedClock(), controls)
        return str(camera), {name: value for name, value in capture.set_to if name in self.CONTROLS}

    def test_exposure_gain_and_white_are_fixed_in_video4linux_units(
        self, monkeypatch: pytest.MonkeyPatch, device: str
    ) -> None:
        text, values = self.opened(monkeypatch, device, VideoControls(), FIXED)
        # An exposure is in units of 0.1 ms; 1 is the manual kind.
        assert list(values.values()) == [1, 125, 4, 0, 5500]
        assert tuple(values) == self.CONTROLS
        assert text == f"USB camera {device} (320 × 240 as JPEG)"

    @pytest.mark.parametrize(("fixed", "kind"), [((), 3), ((3,), 0)], ids=["of an aperture", "of any"])
    def test_what_is_not_fixed_is_the_camera_s_again(
        self, monkeypatch: pytest.MonkeyPatch, device: str, fixed: tuple[int, ...], kind: int
    ) -> None:
        class Kinds(VideoControls):
            def set(self, control: int, value: float) -> bool:
                refused = control == cv2.CAP_PROP_AUTO_EXPOSURE and value in fixed
                return not refused and super().set(control, value)

        _, values = self.opened(monkeypatch, device, Kinds(), NO_CONTROLS)
        assert values == {cv2.CAP_PROP_AUTO_EXPOSURE: kind, cv2.CAP_PROP_AUTO_WB: 1}

    def test_what_a_camera_refuses_to_fix_is_named(
        self, monkeypatch: pytest.MonkeyPatch, device: str
    ) -> None:
        text, _ = self.opened(monkeypatch, device, VideoControls(self.CONTROLS), FIXED)
        assert text == (
            f"USB camera {device} (320 × 240 as JPEG; it does not fix the exposure, the gain, the colour "
            "temperature)"
        )


class TestUsbSizes:
    def sizes(self, monkeypatch: pytest.MonkeyPatch, device: str, answers: list[tuple[int, ...]]) -> str:
        """Return the text of a camera, asked for 800 × 600, whose driver lists `answers`: kind, sizes."""

        def answer(_: int, request: int, data: bytearray) -> int:
            # VIDIOC_ENUM_FRAMESIZES; the file that stands in for the device answers nothing else.
            if request != 0xC02C564A:
                raise OSError(errno.ENOTTY, "Inappropriate ioctl for device")
            index, pixel_format = struct.unpack_from("=II", data)
            assert pixel_format == cv2.VideoWriter.fourcc(*"MJPG")
            if index >= len(answers):
                raise OSError(errno.EINVAL, "Invalid argument")
            struct.pack_into(f"={len(answers[index])}I", data, 8, *answers[index])
            return 0

        monkeypatch.setattr("robot_runtime.vision.video_device.ioctl", answer)
        monkeypatch.setattr(cv2, "VideoCapture", JpegDevice([]))
        return str(UsbCamera(device, 800, 600, 15.0, SimulatedClock()))

    def test_a_camera_without_the_size_names_those_it_gives(
        self, monkeypatch: pytest.MonkeyPatch, device: str
    ) -> None:
        # Drivers list their usual size a second time.
        answers: list[tuple[int, ...]] = [(1, 640, 480), (1, 320, 240), (1, 640, 480), (1, 1280, 720)]
        assert self.sizes(monkeypatch, device, answers) == (
            f"USB camera {device} (640 × 480, scaled to 800 × 600; it gives 640 × 480, 320 × 240, 1280 × 720)"
        )

    def test_a_range_of_sizes_is_named(self, monkeypatch: pytest.MonkeyPatch, device: str) -> None:
        text = self.sizes(monkeypatch, device, [(3, 32, 1920, 2, 16, 1080, 4)])
        assert text.endswith("; it gives 32 × 16 to 1920 × 1080)")

    def test_a_driver_without_a_list_names_none(self, monkeypatch: pytest.MonkeyPatch, device: str) -> None:
        text = self.sizes(monkeypatch, device, [])
        assert text == f"USB camera {device} (640 × 480, scaled to 800 × 600)"


class TestUsbCamera:
    """The camera's device is a file, which OpenCV's other reader plays: the kernel here has no camera."""

    @pytest.fixture
    def video(self, tmp_path: Path) -> Path:
        return make_video(tmp_path / "camera.mp4", "mp4v")

    def test_pictures_come_scaled_and_with_a_time_of_the_steady_clock(
        self, video: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(cv2, "CAP_V4L2", cv2.CAP_FFMPEG)
        camera = UsbCamera(str(video), 320, 240, 10.0, SimulatedClock(70.0))
        frames = [camera.read() for _ in range(3)]
        assert [round(float(frame.picture.mean()) / 20) for frame in frames] == [0, 1, 2]
        assert frames[0].picture.shape == (240, 320, 3)
        assert frames[0].picture.dtype == np.uint8
        assert {frame.taken for frame in frames} == {70.0}  # the file counts from its own beginning
        assert str(camera) == f"USB camera {video} (160 × 120, scaled to 320 × 240)"
        camera.close()

    def test_a_camera_that_ends_is_reported(self, video: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(cv2, "CAP_V4L2", cv2.CAP_FFMPEG)
        camera = UsbCamera(str(video), 160, 120, 10.0, SimulatedClock())
        for _ in range(12):
            camera.read()
        with pytest.raises(CameraError, match="gives no picture; check its plug"):
            camera.read()

    def test_a_missing_device_is_reported(self, tmp_path: Path) -> None:
        with pytest.raises(CameraError, match=r"there is no camera .*video9 \(devices: .*\); plug it in"):
            UsbCamera(str(tmp_path / "video9"), 320, 240, 4.0, SimulatedClock())

    def test_a_device_that_is_no_camera_is_reported(self, tmp_path: Path) -> None:
        (tmp_path / "video9").touch()
        with pytest.raises(CameraError, match="gives no video: it is no camera, or has no pictures"):
            UsbCamera(str(tmp_path / "video9"), 320, 240, 4.0, SimulatedClock())

    @pytest.mark.parametrize(
        ("problem", "message"),
        [
            (PermissionError(errno.EACCES, "Permission denied"), "put the user into the group video"),
            (OSError(errno.EBUSY, "Device or resource busy"), "another program uses it"),
            (OSError(errno.ENODEV, "No such device"), "cannot be opened: No such device"),
        ],
    )
    def test_a_device_that_cannot_be_opened_is_reported(
        self, monkeypatch: pytest.MonkeyPatch, problem: OSError, message: str
    ) -> None:
        def refuse(*_: object) -> int:
            raise problem

        monkeypatch.setattr(os, "open", refuse)
        with pytest.raises(CameraError, match=message):
            UsbCamera("", 320, 240, 4.0, SimulatedClock())


def test_only_the_pi_camera_loads_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "picamera2", SimpleNamespace())
    file = tmp_path / "a.png"
    cv2.imwrite(str(file), drawn(1.0, None))
    FileCamera(file, 64, 48, SimulatedClock()).close()
