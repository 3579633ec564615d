"""The rendered camera at 640 × 480: pictures a second on this computer's CPU, and where the time goes."""

import time
from math import sin
from statistics import median

from robot_runtime.contract.documents import Truth
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.simulation.scene.contents import Contents
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.surroundings import Basin

_SIZE = (640, 480)
_PICTURES = 100
_WARM = 5


def measure() -> dict[str, float]:
    """A robot that swims and rolls, with the underwater look; `camera.fps` is that of the slower scene."""
    problem = missing()
    if problem:
        raise RuntimeError(problem)
    natural = _measure(Contents())
    pool = _measure(Contents(basin=Basin(2.5, 12.0, 6.0)))
    figures = {f"camera.{part}_ms.natural": value for part, value in natural.items()}
    figures |= {f"camera.{part}_ms.pool": value for part, value in pool.items()}
    return {"camera.fps": 1000 / max(sum(natural.values()), sum(pool.values())), **figures}


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
