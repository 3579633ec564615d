"""Control while a decoder crashes, hangs and eats memory: its jitter, the alarm, and the restart.

The whole robot swims in real time, with `make bench ONLY=decoder`.
"""

import os
import signal
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import psutil

from bench import jitter
from robot_runtime.vision.process import HUNG_SECONDS, STEADY_SECONDS
from tests.proofs.watching import Viewer
from tests.runtime.vision.harness import uncompressed_video
from tests.stack import Stack
from tests.waiting import wait_for

_SECONDS = 40.0
"""Of each phase, at least."""
_SETTLE = 5.0
_PATIENCE = HUNG_SECONDS + 20.0
_MISSING = "no picture: "
_HUGE = 9000
"""px; a decoder needs more than one such picture's 243 MB."""

Phases = dict[str, tuple[float, float]]


def measure() -> dict[str, float]:
    """Return the ms by which the time between two control ticks differs from their period, p50 and p999, of
    phases: without a fault, with a vision process that crashes whenever it gives pictures, that hangs, with a
    video that crashes OpenCV's decoder whenever it is opened, and with one whose pictures are larger than the
    process's memory. s until the camera's state names the first fault of a phase, until the alarm, and until
    pictures come again.
    """
    uncompressed = _with_video("video", uncompressed_video(), "crashed the decoder")
    return _with_faults() | uncompressed | _with_video("eating", _huge_video(), "holds no picture")


def _with_faults() -> dict[str, float]:
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        data = Path(folder) / "data"
        with _Swim(data, 'camera = "card"') as swim:
            swim.phase("well", lambda: 0)
            swim.phase("crashing", lambda: swim.fault("crash", _crash))
            swim.phase("hanging", lambda: swim.fault("hang", psutil.Process.suspend))
        return swim.figures()


def _with_video(phase: str, content: bytes, failure: str) -> dict[str, float]:
    """Show a video all the time, whose `failure` the camera's state names."""
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        video = Path(folder) / "video.avi"
        video.write_bytes(content)
        with _Swim(Path(folder) / "data", f'camera = "file"\nfile = "{video}"') as swim:
            swim.phase(phase, lambda: 0)
            wait_for(lambda: failure in swim.camera, f"the camera's state: {failure}", _PATIENCE)
        return swim.figures()


def _huge_video() -> bytes:
    """Return a video of one black picture, 243 MB as pixels and 0.5 MB as a file."""
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        file = Path(folder) / "huge.avi"
        writer = cv2.VideoWriter(str(file), cv2.VideoWriter.fourcc(*"MJPG"), 4, (_HUGE, _HUGE))
        writer.write(np.zeros((_HUGE, _HUGE, 3), np.uint8))
        writer.release()
        return file.read_bytes()


class _Swim:
    """A robot that holds its depth, armed and recording."""

    def __init__(self, data: Path, vision: str) -> None:
        self._data = data
        self._phases: Phases = {}
        self._figures: dict[str, float] = {}
        data.mkdir()
        config = data / "robot.toml"
        config.write_text(f"[vision]\n{vision}\n", "utf-8")
        self._stack = Stack(data, "--config", str(config))

    def __enter__(self) -> "_Swim":
        self._stack.__enter__()
        self._viewer = Viewer(self._stack)
        recording = self._stack.api.post("/sessions", json={"name": "bench"}).raise_for_status()
        self._session = int(recording.json()["id"])
        self._stack.arm()
        time.sleep(_SETTLE)
        return self

    def __exit__(self, *_: object) -> None:
        self._figures["decoder.armed_at_the_end"] = float(self._viewer.state["armed"])
        self._viewer.close()
        self._stack.api.post("/robot/stop")
        self._stack.api.post(f"/sessions/{self._session}/stop")
        self._stack.__exit__(None, None, None)

    def phase(self, name: str, act: Callable[[], object]) -> None:
        """Act again and again for the time of a phase, which begins with a camera that works."""
        # What fails sooner after another fault belongs to that one, and is not told of again.
        time.sleep(STEADY_SECONDS + 1.0)
        began = time.monotonic()
        while time.monotonic() < began + _SECONDS:
            act()
            time.sleep(0.1)
        self._phases[name] = began, time.monotonic()

    def fault(self, name: str, cause: Callable[[psutil.Process], object]) -> None:
        """Cause a fault of the vision process, and wait until pictures come again."""
        self._stack.api.post("/robot/commands/acknowledge").raise_for_status()
        wait_for(lambda: not self._viewer.tells("vision_stale"), "the end of the alarm")
        vision, began = self._stack.part("vision"), time.monotonic()
        cause(vision)
        if name == "hang":
            alarm = wait_for(lambda: self._viewer.tells("vision_stale"), "the alarm")
            self._figures.setdefault("decoder.alarm_s.hang", alarm - began)
        if f"decoder.named_s.{name}" not in self._figures:
            # The next ones of a series may be over before the next state.
            named = wait_for(self._is_named, f"the camera's state after {name}", _PATIENCE)
            self._figures[f"decoder.named_s.{name}"] = named - began
        again = wait_for(lambda: self._is_back(began), f"pictures after {name}", _PATIENCE)
        self._figures.setdefault(f"decoder.pictures_again_s.{name}", again - began)

    def figures(self) -> dict[str, float]:
        """Return all figures of the swim, which is over."""
        figures = jitter.figures(self._data, self._session, self._phases)
        return {name.replace("jitter.", "decoder."): value for name, value in figures.items()} | self._figures

    @property
    def camera(self) -> str:
        """The camera's description in the robot's newest state."""
        return str(self._viewer.state.get("camera", ""))

    def _is_named(self) -> bool:
        return self.camera.startswith(_MISSING)

    def _is_back(self, since: float) -> bool:
        return not self._is_named() and self._viewer.fresh(("detection",), since)


def _crash(vision: psutil.Process) -> None:
    os.kill(vision.pid, signal.SIGSEGV)
