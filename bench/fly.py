"""The camera's stream of the whole simulated robot, recording: pictures a second, their age, and their cost.

The jitter of the control loop and the processor time of each process are measured without a viewer of the
stream and with one, in the same run. The age is that at which a page gets a picture, by the robot's clock.
"""

import json
import tempfile
import threading
import time
from pathlib import Path
from statistics import quantiles

import cv2
import numpy as np
from websockets.sync.client import connect
from websockets.typing import Origin

from bench import jitter
from bench.real_robot import pids
from robot_runtime.config import VisionConfig
from robot_runtime.contract.topics import CAMERA, TIME
from robot_runtime.transport.blocks import HEADER
from server.features.bench.live_viewer import LiveViewer
from server.features.bench.process_figures import core_percent
from server.platform.settings import DataFolder
from tests.shell import shell_headers
from tests.stack import Stack

_SETTLE = 8.0
"""s: the first picture waits for the scene, and the quality finds its step."""
_SECONDS = 30.0


def measure() -> dict[str, float]:
    """Measure half a minute without the stream and half a minute with it."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        with Stack(data) as stack:
            session = stack.api.post("/sessions", json={"name": "bench"}).raise_for_status().json()["id"]
            stack.arm()
            phases = {}
            figures: dict[str, float] = {}
            with LiveViewer(DataFolder(data)):
                time.sleep(_SETTLE)
                phases["stream_off"] = _phase(stack, "off", figures)
                watcher = _Watcher(stack)
                time.sleep(_SETTLE)
                watcher.begin()
                phases["stream_on"] = _phase(stack, "on", figures)
                pictures = watcher.end()
            stack.api.post("/robot/stop").raise_for_status()
            stack.api.post(f"/sessions/{session}/stop")
        figures |= jitter.figures(data, session, phases)
    ages = [1000 * (arrived - taken) for arrived, taken, _ in pictures]
    sizes = [len(jpeg) for _, _, jpeg in pictures]
    full = sum(_width(jpeg) >= VisionConfig().stream_width for _, _, jpeg in pictures)
    return figures | {
        "fly.picture_hz": full / _SECONDS,
        "fly.picture_hz.any_size": len(pictures) / _SECONDS,
        "fly.picture_age_ms_p95": quantiles(ages, n=100)[94],
        "fly.picture_age_ms_p50": quantiles(ages, n=100)[49],
        "fly.picture_kb": sum(sizes) / len(sizes) / 1000,
    }


def _phase(stack: Stack, name: str, figures: dict[str, float]) -> tuple[float, float]:
    """Add the processor time of half a minute to `figures`; return its times."""
    processes = {part: stack.part(part) for part in ("runtime", "vision", "scene")}
    began = time.monotonic()
    cpu = core_percent(pids(processes | {"server": stack.server}), _SECONDS)
    figures |= {f"fly.cpu.{part}_percent.stream_{name}": value for part, value in cpu.items()}
    return began, began + _SECONDS


class _Watcher:
    """A client that watches the camera's stream and keeps its pictures, with the times of their arrival."""

    def __init__(self, stack: Stack) -> None:
        self._pictures: list[tuple[float, float, bytes]] = []
        self._socket = connect(
            f"{stack.url.replace('http', 'ws', 1)}/api/live",
            origin=Origin(stack.url),
            additional_headers=shell_headers(DataFolder(stack.data)),
            max_size=None,
            proxy=None,
        )
        self._socket.__enter__()
        self._socket.send(json.dumps({"op": "watch", "pictures": [CAMERA.name]}))
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def begin(self) -> None:
        """Forget the pictures so far."""
        self._pictures = []

    def end(self) -> list[tuple[float, float, bytes]]:
        """Disconnect; return the arrival (s), the time (s) and the JPEG file of each picture."""
        pictures = self._pictures
        self._socket.__exit__(None, None, None)
        self._thread.join()
        return pictures

    def _read(self) -> None:
        for message in self._socket:
            now = time.monotonic()
            if isinstance(message, bytes) and HEADER.unpack_from(message)[0] == CAMERA.id:
                (taken,) = TIME.unpack_from(message, HEADER.size)
                self._pictures.append((now, taken, message[HEADER.size + TIME.size :]))


def _width(jpeg: bytes) -> int:
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    return int(picture.shape[1])
