"""The vision process: what a decoder that crashes, hangs or eats memory leaves of the rest."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from struct import Struct
from typing import Literal

import cv2
import numpy as np
import psutil
import pytest

from robot_runtime.clock import SimulatedClock, SteadyClock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.commands import FilmCommand
from robot_runtime.contract.documents import Detection, Event
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.errors import RefusedError
from robot_runtime.vision import process as process_module
from robot_runtime.vision.interface import VisionOutputs
from robot_runtime.vision.messages import MessageError, MessageSocket
from robot_runtime.vision.process import VisionProcess
from tests.runtime.vision.harness import uncompressed_video
from tests.waiting import SECONDS

CARD = VisionConfig(camera="card", width=64, height=48, rate=20.0)


class VisionRecord:
    """All that came of a vision process."""

    def __init__(self) -> None:
        self.detections: list[Detection] = []
        self.events: list[Event] = []
        self.pictures: list[tuple[str, bytes]] = []
        self.thumbnails: list[bytes] = []
        self.film: list[tuple[float, bytes]] = []
        self.snapshots: list[tuple[float, bytes]] = []
        self.watching: set[str] = set()
        self.outputs = VisionOutputs(
            detection=self.detections.append,
            event=self.events.append,
            picture=lambda topic, _, jpeg: self.pictures.append((topic.name, jpeg)),
            film=lambda time, picture: self.film.append((time, picture)),
            thumbnail=lambda _, jpeg: self.thumbnails.append(jpeg),
            snapshot=lambda time, jpeg: self.snapshots.append((time, jpeg)),
            watched=lambda topic: topic.name in self.watching,
        )

    @property
    def texts(self) -> list[str]:
        """The texts of the events."""
        return [event.text for event in self.events]

    def wait(self, condition: Callable[[], object], what: str) -> None:
        """Wait until the condition holds."""
        end = time.monotonic() + SECONDS
        while not condition():
            assert time.monotonic() < end, f"no {what}; events: {self.texts}"
            time.sleep(0.005)

    def wait_for_pictures(self, count: int = 2) -> None:
        """Wait for so many pictures from now on."""
        enough = len(self.detections) + count
        self.wait(lambda: len(self.detections) >= enough, "pictures")


@pytest.fixture
def seen() -> VisionRecord:
    return VisionRecord()


@contextmanager
def running(seen: VisionRecord, config: VisionConfig = CARD, *program: str) -> Iterator[VisionProcess]:
    vision = VisionProcess(
        config,
        SteadyClock(),
        seen.outputs,
        "turtle",
        "unixsock-stream/nowhere",
        program or process_module.PROGRAM,
    )
    vision.start()
    try:
        yield vision
    finally:
        vision.close()
        assert vision.pid is None


@contextmanager
def faulty(
    seen: VisionRecord, folder: Path, camera: Literal["file", "usb"] = "file"
) -> Iterator[VisionProcess]:
    config = replace(CARD, camera=camera, file="pool.avi")
    program = (sys.executable, "-m", "tests.runtime.vision.faulty_vision", str(folder))
    with running(seen, config, *program) as vision:
        seen.wait_for_pictures()
        seen.wait(lambda: vision.text == "faulty camera", "camera")
        yield vision


def crash(vision: VisionProcess, seen: VisionRecord, fault: Path) -> None:
    fault.touch()
    seen.wait(lambda: vision.text.startswith("no picture: "), "failure")


class TestPictures:
    def test_pictures_detections_and_thumbnails_come(self, seen: VisionRecord) -> None:
        with running(seen) as vision:
            assert vision.refusals() == ["The camera's software is being loaded. Wait a moment."]
            seen.wait_for_pictures()
            assert vision.refusals() == []
            assert seen.pictures == []
            seen.watching = {"picture", "mask"}
            seen.wait(lambda: {topic for topic, _ in seen.pictures} == {"picture", "mask"}, "pictures")
            picture = cv2.imdecode(np.frombuffer(seen.pictures[0][1], np.uint8), cv2.IMREAD_COLOR)
            assert picture is not None
            assert picture.shape == (48, 64, 3)
            seen.watching = set()
            # A picture that was being made meanwhile still comes.
            seen.wait_for_pictures(3)
            report = len(seen.pictures)
            seen.wait_for_pictures(3)
            assert len(seen.pictures) == report
            assert seen.thumbnails
            assert vision.text == "drawn water without a card"
            assert seen.events == []

    def test_cards_settings_and_picked_colours_pass_to_and_fro(self, seen: VisionRecord) -> None:
        with running(seen) as vision:
            vision.show_card("yellow")
            seen.wait(lambda: seen.detections and seen.detections[-1].target == "yellow", "card")
            assert vision.card == "yellow"
            seen.wait(lambda: vision.text == "drawn water with a yellow card", "text")
            assert vision.pick({"x": 0.5, "y": 0.5})["colour"]["hue"][0] > 15
            taken = vision.take_snapshot()["time"]
            assert [(time, jpeg[:2]) for time, jpeg in seen.snapshots] == [(taken, b"\xff\xd8")]
            with pytest.raises(RefusedError, match="between 0 and 1"):
                vision.pick({"x": 2.0, "y": 0.5})
            with pytest.raises(RefusedError, match="no card of colour 'pink'"):
                vision.show_card("pink")
            vision.settings = VisionSettings(colour="red", actions={"yellow": 2.0}, rate=20.0)
            seen.wait(lambda: seen.detections[-1].set_point == 2.0, "action")

    def test_a_receiver_that_fails_is_no_end(
        self, seen: VisionRecord, caplog: pytest.LogCaptureFixture
    ) -> None:
        def fail(detection: Detection) -> None:
            seen.detections.append(detection)
            raise RuntimeError("nobody wants to know")

        seen.outputs = replace(seen.outputs, detection=fail)
        with running(seen):
            seen.wait_for_pictures(4)
        assert "nobody wants to know" in caplog.text
        assert seen.events == []

    def test_without_opencv_the_camera_says_so_and_is_not_tried_again(
        self, seen: VisionRecord, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (tmp_path / "cv2.py").write_text("raise ImportError('no OpenCV here')\n")
        monkeypatch.setenv("PYTHONPATH", str(tmp_path))
        with running(seen) as vision:
            seen.wait(lambda: vision.missing and vision.pid is None, "end of it")
            assert vision.text.startswith("no picture: NumPy and OpenCV cannot be loaded (no OpenCV here)")
            assert "sudo apt install python3-opencv" in vision.text
            assert [event.kind for event in seen.events] == ["camera"]
            assert vision.refusals() == []
            with pytest.raises(RefusedError, match="OpenCV cannot be loaded"):
                vision.show_card("yellow")
            with pytest.raises(RefusedError, match="OpenCV cannot be loaded"):
                vision.pick({"x": 0.5, "y": 0.5})


def test_a_command_never_waits_for_a_process_that_hangs(
    seen: VisionRecord, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process_module, "HUNG_SECONDS", 10 * SECONDS)
    with faulty(seen, tmp_path) as vision:
        before = vision.pid
        (tmp_path / "hang").touch()
        seen.wait((tmp_path / "hangs").exists, "hang")
        for _ in range(2000):
            vision.settings = replace(vision.settings, colour="red")
        # What it did not read would be lost: the next one is told all.
        seen.wait(lambda: vision.pid not in (before, None), "next process")
        (tmp_path / "hang").unlink()


class TestFaults:
    def test_a_crash_is_named_and_what_was_set_applies_again(
        self, seen: VisionRecord, tmp_path: Path
    ) -> None:
        with faulty(seen, tmp_path) as vision:
            changed = replace(vision.settings, colour="red")
            vision.settings = changed
            before = vision.pid
            crash(vision, seen, tmp_path / "crash")
            assert vision.text == "no picture: reading pool.avi crashed the decoder (SIGSEGV)"
            with pytest.raises(RefusedError, match=r"no picture to pick.*crashed the decoder \(SIGSEGV\)"):
                vision.pick({"x": 0.5, "y": 0.5})
            (tmp_path / "crash").unlink()
            seen.wait(lambda: vision.text == "faulty camera", "recovery")
            assert vision.pid != before
            assert vision.settings is changed
        assert [event.severity for event in seen.events] == ["caution"]
        assert seen.texts == [
            "Camera: reading pool.avi crashed the decoder (SIGSEGV). It is started again at once; "
            "control goes on."
        ]

    def test_a_film_goes_on_with_the_process_that_comes(self, seen: VisionRecord, tmp_path: Path) -> None:
        with faulty(seen, tmp_path) as vision:
            vision.film(FilmCommand(seconds=120.0))
            seen.wait(lambda: seen.film, "film")
            crash(vision, seen, tmp_path / "crash")
            (tmp_path / "crash").unlink()
            before = len(seen.film)
            seen.wait(lambda: len(seen.film) > before, "film of the next process")

    def test_a_series_of_crashes_is_reported_once_and_its_pauses_grow(
        self, seen: VisionRecord, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(process_module, "STEADY_SECONDS", 0.0)
        pauses = []

        def describe(pause: float) -> str:
            pauses.append(pause)
            return "soon"

        monkeypatch.setattr(process_module, "describe_pause", describe)
        with faulty(seen, tmp_path) as vision:
            crash(vision, seen, tmp_path / "crash")
            seen.wait(lambda: len(pauses) == 4, "crashes")
            assert len(seen.events) == 1
            (tmp_path / "crash").unlink()
            seen.wait(lambda: len(seen.events) == 2, "report of the recovery")
        assert pauses[0] == 0.0
        assert pauses[-1] >= 0.4
        assert seen.events[1].severity == "info"
        assert seen.texts[1] == "Camera: faulty camera."

    def test_a_hang_is_named_and_its_process_replaced(
        self, seen: VisionRecord, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        with faulty(seen, tmp_path, "usb") as vision:
            before = vision.pid
            monkeypatch.setattr(process_module, "SILENT_SECONDS", 0.5)
            monkeypatch.setattr(process_module, "HUNG_SECONDS", 3.0)
            seen.wait_for_pictures(1)
            crash(vision, seen, tmp_path / "hang")
            assert vision.text == "no picture: reading the USB camera pool.avi takes more than 0.5 s"
            assert vision.pid == before
            with pytest.raises(RefusedError, match=r"takes more than 0\.5 s"):
                vision.pick({"x": 0.5, "y": 0.5})
            seen.wait(lambda: "its process was ended" in vision.text, "end of it")
            (tmp_path / "hang").unlink()
            monkeypatch.undo()
            seen.wait(lambda: vision.text == "faulty camera", "recovery")
        assert len(seen.events) == 1

    def test_a_process_that_eats_memory_ends_at_its_limit(self, seen: VisionRecord, tmp_path: Path) -> None:
        with faulty(seen, tmp_path) as vision:
            crash(vision, seen, tmp_path / "eat")
            assert vision.text == "no picture: reading pool.avi needed more memory than its 300 MB"
            (tmp_path / "eat").unlink()
            seen.wait(lambda: vision.text == "faulty camera", "recovery")

    def test_an_uncompressed_video_which_crashes_some_decoders_does_not_reach_this_process(
        self, seen: VisionRecord, tmp_path: Path
    ) -> None:
        video = tmp_path / "v.avi"
        video.write_bytes(uncompressed_video())
        with running(seen, replace(CARD, camera="file", file=str(video))) as vision:
            seen.wait(lambda: vision.text != "starting", "picture or failure")
            crashed = "no picture: reading v.avi crashed the decoder ("
            assert vision.text.startswith(("file v.avi", crashed))


def test_it_ends_with_its_parent_however_that_ends(tmp_path: Path) -> None:
    (tmp_path / "hang").touch()
    with subprocess.Popen(
        [sys.executable, "-m", "tests.runtime.vision.lonely_parent", str(tmp_path)],
        stdout=subprocess.PIPE,
    ) as parent:
        assert parent.stdout is not None
        child = psutil.Process(int(parent.stdout.readline()))
        parent.kill()
        # It hangs, so that it reads no end of its input.
        child.wait(SECONDS)


def test_a_camera_that_fails_slowly_again_and_again_is_reported_once(seen: VisionRecord) -> None:
    clock = SimulatedClock(20.0)
    vision = VisionProcess(CARD, clock, seen.outputs, "turtle", "nowhere")
    vision._started = 0.0
    for _ in range(3):
        vision._fail("reading takes long", "")
        vision._failure = ""
        vision._take_camera("no picture: no light")
        vision._recover()
    assert len(seen.events) == 1
    vision._take_camera("lamp")
    vision._recover()
    assert seen.texts[1:] == ["Camera: lamp."]


class TestEnd:
    def test_the_signals_of_the_group_do_not_end_it_before_its_parent(self, seen: VisionRecord) -> None:
        with running(seen) as vision:
            seen.wait_for_pictures()
            child = vision.pid
            assert child is not None
            os.kill(child, signal.SIGINT)
            os.kill(child, signal.SIGTERM)
            seen.wait_for_pictures(4)
            assert vision.pid == child
        assert seen.events == []

    def test_it_holds_nothing_of_its_parent_open(self, seen: VisionRecord, tmp_path: Path) -> None:
        with (tmp_path / "port").open("wb") as port, running(seen) as vision:
            os.set_inheritable(port.fileno(), True)
            seen.wait_for_pictures()
            files = {file.path for file in psutil.Process(vision.pid).open_files()}
            assert str(tmp_path / "port") not in files

    def test_it_gives_way_to_control_and_goes_first_where_memory_is_short(self, seen: VisionRecord) -> None:
        with running(seen) as vision:
            seen.wait_for_pictures()
            assert psutil.Process(vision.pid).nice() > psutil.Process().nice()
            assert Path(f"/proc/{vision.pid}/oom_score_adj").read_text() == "500\n"

    def test_neither_close_nor_a_picked_colour_waits_long_for_a_process_that_hangs(
        self, seen: VisionRecord, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(process_module, "ANSWER_SECONDS", 0.1)
        with faulty(seen, tmp_path) as vision:
            (tmp_path / "hang").touch()
            seen.wait((tmp_path / "hangs").exists, "hang")
            with pytest.raises(RefusedError, match="does not answer"):
                vision.pick({"x": 0.5, "y": 0.5})
            vision.close()
            assert vision.pid is None


class TestMessages:
    @pytest.fixture
    def ends(self) -> Iterator[tuple[MessageSocket, socket.socket]]:
        ours, theirs = socket.socketpair()
        with ours, theirs:
            yield MessageSocket(ours), theirs

    def test_pieces_of_messages_are_put_together(self, ends: tuple[MessageSocket, socket.socket]) -> None:
        messages, other = ends
        text = json.dumps({"a": 1}).encode()
        data = (Struct("<II").pack(len(text), 3) + text + b"xyz") * 2
        for cut in range(len(data)):
            other.send(data[:cut])
            other.send(data[cut:])
            got = messages.receive(1.0)
            while len(got) < 2:
                got += messages.receive(1.0)
            assert [(message.table, message.attachment) for message in got] == [({"a": 1}, b"xyz")] * 2
        assert messages.receive(0.0) == []

    @pytest.mark.parametrize(
        "data", [b"\xff" * 8, Struct("<II").pack(3, 0) + b"nul", Struct("<II").pack(1, 0) + b"1"]
    )
    def test_what_is_no_message_is_refused(
        self, ends: tuple[MessageSocket, socket.socket], data: bytes
    ) -> None:
        ends[1].send(data)
        with pytest.raises(MessageError):
            ends[0].receive(1.0)

    def test_a_full_socket_is_not_waited_for(self, ends: tuple[MessageSocket, socket.socket]) -> None:
        sent = 0
        while ends[0].send_at_once({"text": "x" * 10_000}):
            sent += 1
            assert sent < 1000
        assert sent > 3

    def test_the_end_of_the_other_end(self, ends: tuple[MessageSocket, socket.socket]) -> None:
        ends[1].close()
        with pytest.raises(EOFError):
            ends[0].receive(1.0)
