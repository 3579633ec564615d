"""Messages of Foxglove's well-known schemas, for MCAP files and for the live connection.

Frames: `world` has its z axis upwards, as 3-D panels expect; `ned` in it points north, east, down; `turtle`
is the body (forward, right, down). Times are in ns since 1970.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from robot_runtime.contract import topics
from server.interchange.pose_tracker import Pose

WORLD, NED, BODY = "world", "ned", "turtle"
LEVELS = {"info": 2, "caution": 3, "alarm": 4}
"""foxglove.LogLevel of a severity."""
DEBUG_LEVEL_OFFSET = 1
"""From DebugLevel to foxglove.LogLevel, which begins with UNKNOWN."""

Message = dict[str, Any]


def timestamp(time: int) -> dict[str, int]:
    """Return the time as a Foxglove timestamp."""
    seconds, rest = divmod(time, 1_000_000_000)
    return {"sec": seconds, "nsec": rest}


def world_transform(time: int) -> Message:
    """Return the FrameTransform from `world` to `ned`."""
    return _transform(time, WORLD, NED, Pose((0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)))


def body_transform(time: int, pose: Pose) -> Message:
    """Return the FrameTransform from `ned` to the body."""
    return _transform(time, NED, BODY, pose)


def pose_in_frame(time: int, pose: Pose) -> Message:
    """Return a foxglove.PoseInFrame."""
    placed = {"position": _vector(pose.position), "orientation": _quaternion(pose.attitude)}
    return {"timestamp": timestamp(time), "frame_id": NED, "pose": placed}


def compressed_image(time: int, data: str | bytes) -> Message:
    """Return a foxglove.CompressedImage; JSON holds `data` in base64."""
    return {"timestamp": timestamp(time), "frame_id": "camera", "data": data, "format": "jpeg"}


def compressed_video(time: int, data: str | bytes) -> Message:
    """Return a foxglove.CompressedVideo of one picture of H.264 with start codes; `data` as of an image."""
    return {"timestamp": timestamp(time), "frame_id": "camera", "data": data, "format": "h264"}


def log_line(time: int, topic: str, document: Mapping[str, Any]) -> Message:
    """Return a foxglove.Log of a debug line, an event or a bookmark."""
    if topic == topics.DEBUG.name:
        level = int(document["level"]) + DEBUG_LEVEL_OFFSET
    else:
        level = LEVELS.get(str(document.get("severity", "")), LEVELS["info"])
    return {
        "timestamp": timestamp(time),
        "level": level,
        "message": document["text"],
        "name": document.get("kind", topic),
        "file": topic,
        "line": 0,
    }


def _transform(time: int, parent: str, child: str, pose: Pose) -> Message:
    return {
        "timestamp": timestamp(time),
        "parent_frame_id": parent,
        "child_frame_id": child,
        "translation": _vector(pose.position),
        "rotation": _quaternion(pose.attitude),
    }


def _vector(position: Sequence[float]) -> dict[str, float]:
    return dict(zip("xyz", position, strict=True))


def _quaternion(attitude: Sequence[float]) -> dict[str, float]:
    return dict(zip("wxyz", attitude, strict=True))
