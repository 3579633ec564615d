"""The camera of a robot in simulated water, rendered by the process of the scene."""

from collections.abc import Callable
from math import isfinite
from typing import TYPE_CHECKING

from robot_runtime.contract.scene_picture import read_picture, write_request
from robot_runtime.errors import NoAnswerError, RefusedError
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame
from robot_runtime.vision.cards import CameraCard

if TYPE_CHECKING:
    from robot_runtime.transport.zenoh_transport import ZenohTransport

READY_TIMEOUT = 1.0
PICTURE_TIMEOUT = 16.0
"""s; the first picture waits until all of the scene is made."""
PATIENCE = 8.0
"""s before a missing picture is reported: board, simulator and scene start after the runtime."""


class SceneMissingError(Exception):
    """The process of the scene cannot render; the text says what is missing and how to install it."""


class SceneCamera(Camera):
    """A camera that queries pictures of `width` × `height` pixels; `card` returns the shown card, if any.

    Raises CameraError if no scene answers, SceneMissingError if it answers that it cannot render.
    """

    def __init__(
        self,
        width: int,
        height: int,
        messages: "ZenohTransport",
        card: Callable[[], CameraCard | None],
    ) -> None:
        self.size = (width, height)
        self._messages = messages
        self._card = card
        try:
            missing = messages.query("scene/ready", {}, READY_TIMEOUT)["missing"]
        except NoAnswerError as problem:
            raise CameraError(
                "no scene answers. It belongs to a simulated robot and starts with the server. For a real "
                "robot, name its camera in robot.toml, [vision] camera",
                PATIENCE,
            ) from problem
        if missing is not None:
            raise SceneMissingError(str(missing))

    def read(self) -> CameraFrame:
        """Return the picture from the robot's last known position. Raise CameraError."""
        card = self._card()
        request = write_request(*self.size, card.paint if card else None, marked=bool(card and card.marked))
        try:
            picture = read_picture(self._messages.query_bytes("scene/picture", request, PICTURE_TIMEOUT))
            height, width = picture.pixels.shape[:2]
            if (width, height) != self.size or not isfinite(picture.time):
                raise ValueError(f"it sent {width} × {height} at {picture.time} s")
        except NoAnswerError as problem:
            raise CameraError(
                "the scene no longer answers; see its log on the System page", PATIENCE
            ) from problem
        except (RefusedError, ValueError) as problem:
            raise CameraError(f"the scene gives no picture: {problem}", PATIENCE) from problem
        return CameraFrame(picture.pixels, picture.time)

    def close(self) -> None:
        """Do nothing; no device is open."""

    def __str__(self) -> str:
        card = self._card()
        return f"rendered scene with a {card.name} card" if card else "rendered scene"
