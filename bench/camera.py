"""The rendered camera at 640 × 480: pictures a second on this computer's CPU, and where the time goes.

`camera.fps` is what the vision process gets: from the scene's own process, over Zenoh, in the slower water.
The other figures are the medians of drawing and of the underwater look, without transport.
"""

import subprocess
import sys
import tempfile
import time
from dataclasses import asdict
from math import sin
from statistics import median

from robot_runtime.contract.documents import Truth
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.simulation.scene.contents import Contents
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.surroundings import Basin
from robot_runtime.transport.blocks import Block, row
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.camera import CameraError
from robot_runtime.vision.scene_camera import SceneCamera

_SIZE = (640, 480)
_PICTURES = 100
_WARM = 5
_START_SECONDS = 30.0
_POOL = Basin(2.5, 12.0, 6.0)


def measure() -> dict[str, float]:
    """Measure the camera of a robot that swims and rolls, with the underwater look."""
    problem = missing()
    if problem:
        raise RuntimeError(problem)
    natural = _measure(Contents())
    pool = _measure(Contents(basin=_POOL))
    figures = {f"camera.{part}_ms.natural": value for part, value in natural.items()}
    figures |= {f"camera.{part}_ms.pool": value for part, value in pool.items()}
    fps = {"natural": _measure_delivery(Contents().basin), "pool": _measure_delivery(_POOL)}
    figures |= {f"camera.fps.{water}": value for water, value in fps.items()}
    return {"camera.fps": min(fps.values()), **figures}


def _measure_delivery(basin: Basin) -> float:
    """Return the pictures a second that a camera reads from the scene's process."""
    beacons: dict[str, object] = {"positions": []}
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
        endpoint = f"unixsock-stream/{folder}/zenoh"
        command = [
            sys.executable,
            "-m",
            "robot_runtime.simulation.scene",
            "--with-parent",
            "--connect",
            endpoint,
        ]
        with ZenohTransport("turtle", [endpoint]) as messages:
            messages.serve("simulator/surroundings", lambda _: {"world": asdict(basin), "beacons": beacons})
            scene = subprocess.Popen(command)
            try:
                camera = _connect(messages)
                for number in range(_WARM):
                    _read(camera, messages, number)
                began = time.perf_counter()
                for number in range(_PICTURES):
                    _read(camera, messages, _WARM + number)
                return _PICTURES / (time.perf_counter() - began)
            finally:
                scene.terminate()
                scene.wait()


def _connect(messages: ZenohTransport) -> SceneCamera:
    """Wait until the scene renders; it must have heard of the robot's position."""
    end = time.monotonic() + _START_SECONDS
    while True:
        try:
            camera = SceneCamera(*_SIZE, messages, lambda: None)
            _read(camera, messages, 0)
        except CameraError:
            if time.monotonic() > end:
                raise
        else:
            return camera


def _read(camera: SceneCamera, messages: ZenohTransport, number: int) -> None:
    now = 0.05 * number
    payload = row(now, _swimming(now).to_bytes())
    messages.publish("truth", Block.of(BY_NAME["truth"], 1, number, payload).data)
    camera.read()


def _measure(contents: Contents) -> dict[str, float]:
    # Here, since this loads MuJoCo, which need not be there.
    from robot_runtime.simulation.scene.scene import SceneRenderer

    rendering: list[float] = []
    looking: list[float] = []
    with SceneRenderer(contents, SimulationParameters()) as scene:
        for number in range(_WARM + _PICTURES):
            now = 0.05 * number
            began = time.perf_counter()
            picture, depth, eye = scene.draw_camera(now, _swimming(now), *_SIZE)
            drawn = time.perf_counter()
            scene.apply_water(picture, depth, eye, now)
            rendering.append(drawn - began)
            looking.append(time.perf_counter() - drawn)
    return {"render": 1000 * median(rendering[_WARM:]), "look": 1000 * median(looking[_WARM:])}


def _swimming(now: float) -> Truth:
    still = (0.0, 0.0, 0.0)
    roll = 0.1 * sin(now)
    return Truth(
        position=(0.2 * now, 0.1 * sin(now), 1.0 + 0.3 * sin(0.5 * now)),
        attitude=((1 - roll * roll) ** 0.5, roll, 0.0, 0.0),
        velocity=still,
        rate=still,
        fins=(sin(8 * now),) * 4,
    )
