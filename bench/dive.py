"""A synthetic dive with the robot's rates and similar values, as input of the recorder.

The depth follows its set point with a delay and swings about it, as under the bang-bang controller; the set
point steps down for a minute in every four, as if a card were shown. Noise is as the sensors', so that it
takes up as much room. Nothing here is physics.
"""

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.documents import (
    Box,
    ControllerChoice,
    DebugLine,
    Detection,
    Document,
    Event,
    Gain,
    Loop,
    Pace,
    State,
    SwimmingCraft,
)
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import BY_NAME, Kind
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.transport.blocks import Block, pack_documents, row
from robot_runtime.vision.node import THUMBNAIL_SECONDS
from robot_runtime.vision.pipeline import THUMBNAIL_WIDTH

Floats = NDArray[np.float64]
Fields = dict[str, Any]
"""Columns by the names of a record's fields, in units; arrays (samples,) or (samples, elements)."""

RATES = {
    "imu": 100.0,
    "depth": 50.0,
    "beacon": 10.0,
    "motor": 50.0,
    "status": 10.0,
    "navigation": 10.0,
    "control": 10.0,
    "link": 1.0,
    "truth": 50.0,
}
STATE_PERIOD = 1.0
VISION_PERIOD = 0.25
CRAFT_PERIOD = 10.0
ARMED_AT = 5.0
"""s after the start; until then the robot floats."""
CARD_EVERY, CARD_FIRST, CARD_SECONDS = 240.0, 60.0, 60.0
SHALLOW, DEEP = 0.5, 1.0
DELAY = 3.0
"""s, time constant of the depth after a step of the set point."""
SWING, SWING_PERIOD = 0.02, 3.0
GRAVITY = 9.81
STROKES = 1.5
"""Hz, strokes of a fin."""


class Dive:
    """The samples of `seconds` from `start` on (s, steady clock); the same seed gives the same.

    The robot is armed after `armed_at` s, and floats until then.
    """

    def __init__(self, start: float, seconds: float, seed: int, armed_at: float = ARMED_AT) -> None:
        self._start = start
        self._armed_at = armed_at
        self._chance = np.random.default_rng(seed)
        self._rows = {name: self._make_rows(name, rate, seconds) for name, rate in RATES.items()}
        self._times = {name: np.ascontiguousarray(rows["row time"]) for name, rows in self._rows.items()}
        """Of the rows; a column of them would be copied at every search."""
        self._documents = _make_documents(start, seconds, armed_at)
        self._thumbnails = _make_thumbnails(self._chance, start, seconds)
        self._numbers = dict.fromkeys([*self._rows, *self._documents, "thumbnail"], 0)

    def until(self, time: float) -> Iterator[Block]:
        """Yield the blocks of samples before `time` (s, steady clock) that were not taken yet."""
        for name, rows in self._rows.items():
            first = self._numbers[name]
            last = int(np.searchsorted(self._times[name], time))
            if last > first:
                yield Block.of(BY_NAME[name], last - first, first, rows[first:last].tobytes())
                self._numbers[name] = last
        for name, all_of_them in self._documents.items():
            first = last = self._numbers[name]
            while last < len(all_of_them) and all_of_them[last].time < time:
                last += 1
            if last > first:
                yield Block.of(BY_NAME[name], last - first, first, pack_documents(all_of_them[first:last]))
                self._numbers[name] = last

        while (number := self._numbers["thumbnail"]) < len(self._thumbnails):
            taken, jpeg = self._thumbnails[number]
            if taken >= time:
                break
            yield Block.of(BY_NAME["thumbnail"], 1, number, row(taken, jpeg))
            self._numbers["thumbnail"] += 1

    def _make_rows(self, name: str, rate: float, seconds: float) -> NDArray[np.void]:
        topic = BY_NAME[name]
        assert topic.kind is Kind.ROWS
        assert issubclass(topic.record, Record)
        since = np.arange(round(seconds * rate)) / rate
        wires = topic.record.wires
        shapes = [(field, "<" + wire.code, (wire.count,)) for field, wire in wires.items()]
        rows = np.zeros(len(since), np.dtype([("row time", "<f8"), *shapes]))
        # The mapped time of the board is not quite even.
        rows["row time"] = self._start + since + self._chance.uniform(0.0, 2e-4, len(since))
        made: Fields = getattr(self, f"_{name}")(since)
        if "time" in wires:
            made["time"] = np.round(since * 1e6) % 2**32
        for field, values in made.items():
            wire = wires[field]
            counts = np.asarray(values, dtype=np.float64).reshape(-1, wire.count) / wire.scale
            rows[field] = counts if wire.code in "fd" else np.round(counts)
        return rows

    def _noise(self, deviation: float, *shape: int) -> Floats:
        return self._chance.normal(0.0, deviation, shape)

    def _imu(self, since: Floats) -> Fields:
        roll = 0.03 * np.sin(2 * np.pi * STROKES * since)
        pitch = 0.05 * np.sin(2 * np.pi * since / SWING_PERIOD)
        count = len(since)
        return {
            "attitude": _quaternion(roll, pitch, _yaw(since)) + self._noise(2e-4, count, 4),
            "rate": self._noise(0.02, count, 3),
            "force": np.array([0.0, 0.0, -GRAVITY]) + self._noise(0.08, count, 3),
        }

    def _depth(self, since: Floats) -> Fields:
        depth = _depth(since, self._armed_at) + self._noise(0.0015, len(since))
        return {"depth": depth, "pressure": 101_325 + 9_780 * depth, "temperature": 18 + since / 7200}

    def _beacon(self, since: Floats) -> Fields:
        return {"right": since % 40 < 15, "left": since % 40 > 25}

    def _motor(self, since: Floats) -> Fields:
        commanded, angle = _fins(since, self._armed_at), _fins(since - 0.04, self._armed_at)
        noise = self._noise(2e-3, len(since), 4)
        return {
            "wanted": commanded,
            "angle": angle + noise,
            "drive": np.clip(120 * (commanded - angle), -63, 63),
        }

    def _status(self, since: Floats) -> Fields:
        return {
            "epoch": np.ones(len(since)),
            "flags": np.where(since >= self._armed_at, 1 + 2 + 8, 2 + 4),
            "battery": 8.2 - since / 3600 + self._noise(0.01, len(since)),
            "loop_worst": 3000 + self._noise(300, len(since)),
            "stack_free": np.full(len(since), 412),
        }

    def _navigation(self, since: Floats) -> Fields:
        return {"z": np.sign(_set_point(since) - _depth(since, self._armed_at))}

    def _control(self, since: Floats) -> Fields:
        depth, set_point = _depth(since, self._armed_at), _set_point(since)
        depth = depth + self._noise(0.0015, len(since))
        return {
            "set_point": set_point,
            "depth": depth,
            "error": set_point - depth,
            "output": np.sign(set_point - depth),
            "latency": self._chance.uniform(0.004, 0.02, len(since)),
        }

    def _link(self, since: Floats) -> Fields:
        return {
            "bytes_received": 9000 * since,
            "bytes_sent": 450 * since,
            "frames_received": 210 * since,
            "frames_sent": 30 * since,
            "round_trip": self._chance.uniform(0.003, 0.006, len(since)),
            "timeout": np.full(len(since), 0.01),
            "goodput": 9000 + self._noise(20, len(since)),
            "credit": np.full(len(since), 158),
        }

    def _truth(self, since: Floats) -> Fields:
        level = np.zeros(len(since))
        return {
            "position": np.stack([0.02 * since, level, _depth(since, self._armed_at)], axis=1),
            "attitude": _quaternion(level, level, _yaw(since)),
            "velocity": self._noise(0.01, len(since), 3),
            "rate": self._noise(0.02, len(since), 3),
            "fins": _fins(since, self._armed_at),
        }


def _set_point(since: Floats) -> Floats:
    shown = (since - CARD_FIRST) % CARD_EVERY < CARD_SECONDS
    return np.where((since >= CARD_FIRST) & shown, DEEP, SHALLOW)


def _steps(seconds: float, armed_at: float) -> list[tuple[float, float]]:
    cards = np.arange(CARD_FIRST, seconds, CARD_EVERY).tolist()
    return [(armed_at, SHALLOW)] + [
        step for card in cards for step in ((card, DEEP), (card + CARD_SECONDS, SHALLOW))
    ]


def _depth(since: Floats, armed_at: float) -> Floats:
    if since[-1] < armed_at:
        return np.zeros(len(since))
    depth, last = np.zeros(len(since)), 0.0
    before = armed_at
    reached = 0.0
    for at, target in _steps(float(since[-1]) + 1.0, armed_at):
        last = reached + (last - reached) * np.exp(-(at - before) / DELAY)
        after = since >= at
        depth[after] = target + (last - target) * np.exp(-(since[after] - at) / DELAY)
        before, reached = at, target
    swing = SWING * np.sin(2 * np.pi * (since - armed_at) / SWING_PERIOD)
    return depth + np.where(since >= armed_at, swing, 0.0)


def _yaw(since: Floats) -> Floats:
    return 0.3 * np.sin(2 * np.pi * since / 90)


def _quaternion(roll: Floats, pitch: Floats, yaw: Floats) -> Floats:
    """Return a small roll and pitch after a yaw; w, x, y, z in the last axis."""
    w, z = np.cos(yaw / 2), np.sin(yaw / 2)
    x, y = roll / 2, pitch / 2
    whole = np.stack([w, w * x - z * y, w * y + z * x, z], axis=1)
    return np.asarray(whole / np.linalg.norm(whole, axis=1, keepdims=True))


def _fins(since: Floats, armed_at: float) -> Floats:
    stroke = np.where(since >= armed_at, 0.6 * np.sin(2 * np.pi * STROKES * since), 0.0)
    return np.stack([stroke, -stroke, -stroke, stroke], axis=1)


def _make_documents(start: float, seconds: float, armed_at: float) -> dict[str, list[Document]]:
    steps = _steps(seconds, armed_at)
    seen = np.arange(0.0, seconds, VISION_PERIOD)
    deep = _set_point(seen) == DEEP
    box = Box(x=0.3, y=0.3, width=0.4, height=0.4)
    return {
        "state": [_state(start, since, armed_at) for since in np.arange(0.0, seconds, STATE_PERIOD).tolist()],
        "detection": [
            Detection(
                time=start + since + 0.02,
                taken=start + since,
                colour="yellow" if is_deep else None,
                box=box if is_deep else None,
                area=0.16 if is_deep else 0.0,
                processing=0.004,
            )
            for since, is_deep in zip(seen.tolist(), deep.tolist(), strict=True)
        ],
        "debug": [
            DebugLine(time=start + since, level=1, text=f"pass {since:.0f}: all well")
            for since in np.arange(0.5, seconds, 5.0).tolist()
        ],
        "event": [
            Event(time=start + since, kind="set_point", severity="info", text=f"Set point {depth:.2f} m.")
            for since, depth in steps
            if since < seconds
        ],
        "craft": [
            SwimmingCraft(time=start + since, title="Default craft", origin="", craft=Craft())
            for since in np.arange(0.0, seconds, CRAFT_PERIOD).tolist()
        ],
    }


def _make_thumbnails(chance: np.random.Generator, start: float, seconds: float) -> list[tuple[float, bytes]]:
    """Return water with a little noise, and a yellow card where one is shown; times in s, steady clock."""
    since = np.arange(0.0, seconds, THUMBNAIL_SECONDS)
    made = []
    for at, target in zip(since.tolist(), _set_point(since).tolist(), strict=True):
        height = THUMBNAIL_WIDTH * 3 // 4
        picture = np.full((height, THUMBNAIL_WIDTH, 3), (120, 90, 20), np.uint8)
        if target == DEEP:
            picture[36:84, 48:112] = (30, 210, 230)
        picture += chance.integers(0, 12, picture.shape, np.uint8)
        _, jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 50])
        made.append((start + at, jpeg.tobytes()))
    return made


def _state(start: float, since: float, armed_at: float) -> State:
    armed = since >= armed_at
    set_point = float(_set_point(np.array([since]))[0])
    return State(
        run="0" * 16,
        time=start + since,
        mode="automatic" if armed else "disarmed",
        armed=armed,
        armed_since=start + armed_at if armed else None,
        alarms=[],
        pilot_dropped=0,
        refusals=[],
        connected=True,
        connection="The board answers.",
        port="board.tty",
        baud=250_000,
        paces=[
            Pace(topic=name, period=1 / RATES[name]) for name in ("imu", "depth", "beacon", "motor", "status")
        ],
        epoch=1,
        set_point_default=SHALLOW,
        set_point_detected=DEEP,
        deepest=3.0,
        unwatched=30.0,
        steering="none",
        control_rate=10.0,
        vision_rate=4.0,
        vision_colour="yellow",
        colours=["red", "yellow", "green", "blue"],
        card="yellow" if set_point == DEEP else None,
        camera="a drawn picture",
        loops=[
            Loop(
                name="depth",
                on=False,
                set_point=set_point,
                controller="bang_bang",
                controllers=[
                    ControllerChoice(
                        name=controller.name,
                        title=controller.title,
                        gains=[
                            Gain(
                                name=name,
                                value=limits.default,
                                minimum=limits.minimum,
                                maximum=limits.maximum,
                                unit=limits.unit,
                                meaning=limits.meaning,
                            )
                            for name, limits in controller.limits.items()
                        ],
                    )
                    for controller in CONTROLLERS["depth"]
                ],
            )
        ],
    )
