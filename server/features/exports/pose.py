"""Position and attitude of the robot, from several topics, for 3-D panels."""

import json
from typing import Any

from server.features.exports.selection import ExportSelection

PERIOD_NS = 100_000_000
"""Time between two poses; 3-D panels interpolate."""
ENCODE = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode
WORLD, LEVEL, BODY = "world", "ned", "turtle"


class Pose:
    """The pose of the robot, updated by the samples of a recording in order of time.

    The attitude is the IMU's; without one, the simulated body's. The position is the simulated body's where
    there is one; else the depth alone is known, and north and east are 0. Frames: `world` has its z axis
    upwards, as 3-D panels expect; `ned` in it points north, east, down; `turtle` is the body (forward, right,
    down).
    """

    def __init__(self, source: ExportSelection) -> None:
        self._attitude_topic = "imu" if "imu" in source.names else "truth"
        self._position_topic = "truth" if "truth" in source.names else "depth"
        self._has_position = self._position_topic in source.names
        self._position: bytes | None = None
        self._last = -PERIOD_NS
        self.known = self._attitude_topic in source.names
        needed = {self._attitude_topic, self._position_topic}
        self.topics = needed & set(source.names) if self.known else set()
        """The topics that `see` needs."""

    def see(self, name: str, data: bytes, time: int) -> tuple[bytes, bytes] | None:
        """Process a sample of `time` (ns, UTC); returns a FrameTransform and a PoseInFrame when due."""
        if name == self._position_topic:
            self._position = data
        if name != self._attitude_topic or time - self._last < PERIOD_NS:
            return None
        attitude, position = json.loads(data)["attitude"], self._where()
        if position is None or None in attitude:
            return None
        self._last = time
        place = dict(zip("xyz", position, strict=True))
        turn = dict(zip("wxyz", attitude, strict=True))
        pose = {"position": place, "orientation": turn}
        return (
            transform(time, LEVEL, BODY, place, turn),
            dump({"timestamp": stamp(time), "frame_id": LEVEL, "pose": pose}),
        )

    def _where(self) -> list[float] | None:
        if not self._has_position:
            return [0.0, 0.0, 0.0]
        if self._position is None:
            return None
        seen = json.loads(self._position)
        where = seen["position"] if self._position_topic == "truth" else [0.0, 0.0, seen.get("depth")]
        return None if None in where else where


def level(time: int) -> bytes:
    """The FrameTransform from `world` to `ned`."""
    return transform(
        time, WORLD, LEVEL, {"x": 0.0, "y": 0.0, "z": 0.0}, {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}
    )


def transform(
    time: int, parent: str, child: str, translation: dict[str, float], rotation: dict[str, float]
) -> bytes:
    """A foxglove.FrameTransform."""
    return dump(
        {
            "timestamp": stamp(time),
            "parent_frame_id": parent,
            "child_frame_id": child,
            "translation": translation,
            "rotation": rotation,
        }
    )


def stamp(time: int) -> dict[str, int]:
    """A time (ns since 1970) as a Foxglove timestamp."""
    seconds, rest = divmod(time, 1_000_000_000)
    return {"sec": seconds, "nsec": rest}


def dump(message: dict[str, Any]) -> bytes:
    """The JSON of a message."""
    return ENCODE(message).encode()
