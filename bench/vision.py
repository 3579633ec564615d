"""The vision node: computing time of a picture of 640 × 480, and its age when it changes the set point."""

import json
import random
import tempfile
import time
from itertools import pairwise
from pathlib import Path
from statistics import median, quantiles
from typing import Any

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Control
from robot_runtime.contract.vision_settings import COLOURS, VisionSettings
from robot_runtime.transport.blocks import Block, read_blocks, read_rows
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import make_card
from robot_runtime.vision.picture import Picture
from robot_runtime.vision.pipeline import Detector
from tests.stack import Stack

_SIZE = (640, 480)
_PICTURES = 20
_ROUNDS = 10
_RATE = 30
_CHANGES = 120
_PAUSE = (0.25, 0.35)
"""s between two changes: longer than any is on its way, at any moment of a tick of 0.1 s."""
_SETTINGS: dict[str, dict[str, Any]] = {
    "": {},
    ".grey_world": {"white_balance": "grey_world"},
    ".underwater": {"white_balance": "underwater"},
    ".markers": {"markers": "4x4_50"},
    ".all": {"white_balance": "underwater", "markers": "4x4_50"},
}


def measure() -> dict[str, float]:
    """Return the median ms of a core for a search with default settings, more settings, and nothing in sight.

    Latency is from the moment when a picture was taken to the control tick with another set point, over the
    running robot at 30 Hz with the card camera at 640 × 480, whose drawing counts as the exposure does.
    """
    return {**_searches(), **_latencies()}


def _searches() -> dict[str, float]:
    shown = _drawn("yellow")
    figures = {f"vision.ms_per_frame{name}": _search(shown, settings) for name, settings in _SETTINGS.items()}
    # Every other colour is looked for, too.
    figures["vision.ms_per_frame.nothing_seen"] = _search(_drawn(None), {})
    return figures


def _drawn(card: str | None) -> list[Picture]:
    camera = CardCamera(*_SIZE, SimulatedClock(), lambda: None)
    held = make_card(card, COLOURS) if card else None
    return [camera.draw(0.7 * number, held) for number in range(_PICTURES)]


def _search(pictures: list[Picture], settings: dict[str, Any]) -> float:
    detector = Detector(VisionSettings(**settings))
    took = []
    for picture in pictures * _ROUNDS:
        began = time.thread_time()
        detector.search(picture)
        took.append(time.thread_time() - began)
    return 1000 * median(took[_PICTURES:])


def _latencies() -> dict[str, float]:
    chance = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        config = Path(folder) / "robot.toml"
        text = Path("robot.toml").read_text().replace('camera = "scene"', 'camera = "card"')
        for name, before, value in (
            ("width", 320, _SIZE[0]),
            ("height", 240, _SIZE[1]),
            ("rate", 4.0, _RATE),
        ):
            text = text.replace(f"{name} = {before}", f"{name} = {value}")
        config.write_text(text)
        data = Path(folder) / "data"
        runtime = f"unixsock-stream/{data}/run/runtime.sock"
        with (
            Stack(data, "--config", str(config)),
            ZenohTransport("turtle", connect=[runtime], client=True) as robot,
        ):
            ticks: list[Block] = []
            looks: list[Block] = []
            robot.subscribe("control", lambda _, data: ticks.extend(read_blocks(data)))
            robot.subscribe("detection", lambda _, data: looks.extend(read_blocks(data)))
            for change in range(_CHANGES):
                robot.query("command/card", {"colour": None if change % 2 else "yellow"})
                time.sleep(chance.uniform(*_PAUSE))
    return _figures(ticks, looks)


def _figures(ticks: list[Block], looks: list[Block]) -> dict[str, float]:
    seen: list[dict[str, Any]] = [look for block in looks for look in json.loads(block.payload)]
    turns = [
        (after["time"], after["taken"], after["colour"] is not None)
        for before, after in pairwise(seen)
        if (before["colour"] is None) != (after["colour"] is None)
    ]
    rows = [
        (when, row.set_point) for block in ticks for when, row in read_rows(block) if isinstance(row, Control)
    ]
    ages = []
    for (_, before), (when, after) in pairwise(rows):
        causes = [taken for reported, taken, there in turns if reported <= when and there == (after > before)]
        if after != before and causes:
            ages.append(1000 * (when - causes[-1]))
    if len(ages) < _CHANGES / 2:
        raise RuntimeError(f"the set point changed {len(ages)} times, not {_CHANGES}")
    first, last = seen[0]["time"], seen[-1]["time"]
    return {
        "vision.latency_ms_p50": median(ages),
        "vision.latency_ms_p99": quantiles(ages, n=100)[-1],
        "vision.rate_hz": (len(seen) - 1) / (last - first),
        "vision.set_point_changes": len(ages),
    }
