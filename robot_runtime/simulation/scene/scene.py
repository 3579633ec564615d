"""The renderer of the pictures of the robot's camera and of an observer."""

from dataclasses import dataclass
from math import degrees, floor
from types import TracebackType
from typing import Any, Self

import cv2
import mujoco
import numpy as np
from mujoco.egl import GLContext
from numpy.typing import NDArray

from robot_runtime.contract.card_colours import Paint
from robot_runtime.contract.documents import Truth
from robot_runtime.simulation.scene import model as modelling
from robot_runtime.simulation.scene.contents import Contents
from robot_runtime.simulation.scene.optics import Picture, UnderwaterOptics
from robot_runtime.simulation.scene.view import FIELD_OF_VIEW as OBSERVER_VIEW
from robot_runtime.simulation.scene.view import ObserverView
from robot_runtime.simulation.scene.water import NOISE, WaterOptics, water
from robot_runtime.simulation.water.geometry import Matrix, normalize, rotation, to_world
from robot_runtime.simulation.water.parameters import SimulationParameters, Vector

Floats = NDArray[np.float32]

DRIFT = 0.12
"""m/s, speed of the surface's ripples."""
OBSERVER_VISIBILITY = 2.5
"""Factor of the observer's visibility over the camera's, because the picture is for people."""


@dataclass(frozen=True, slots=True)
class _Eye:
    """A point of view: position, axes (forward, right, down) and visible groups."""

    position: Vector
    axes: Matrix
    camera: Any
    groups: tuple[int, ...]


class SceneRenderer:
    """Renderer by MuJoCo, only for the thread that makes it. `close` releases OpenGL.

    The same contents, truth and time give the same pictures. Raises RuntimeError or ImportError without
    OpenGL.
    """

    def __init__(self, contents: Contents, parameters: SimulationParameters) -> None:
        self._parameters = parameters
        self._optics: dict[tuple[int, int, float], UnderwaterOptics] = {}
        self._gl: Any = GLContext(modelling.WIDTH_MAX, modelling.HEIGHT_MAX)
        self._gl.make_current()
        self._context: Any = None
        self._option = mujoco.MjvOption()
        self._nose = mujoco.MjvCamera()
        self._nose.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self.contents = contents
        """The contents of the scene; `fill` changes them."""
        self.fill(contents)

    def fill(self, contents: Contents) -> None:
        """Replace the contents of the scene; where they cannot be built, it stays as it is."""
        model = modelling.build(contents, self._parameters)
        if self._context is not None:
            self._context.free()
            self._context = None
        self._model = model
        self._data = mujoco.MjData(self._model)
        self._view = mujoco.MjvScene(self._model, maxgeom=2000)
        self._context = mujoco.MjrContext(self._model, mujoco.mjtFontScale.mjFONTSCALE_100)
        self._context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._bodies = {
            name: self._model.body(name).mocapid[0]
            for name in ("surface", "ground")
            if name != "ground" or contents.kind == "natural"
        }
        self._nose.fixedcamid = self._model.camera("nose").id
        self._card = self._model.geom("card").id
        self.contents = contents

    def render_camera(
        self,
        time: float,
        truth: Truth,
        width: int,
        height: int,
        card: Paint | None = None,
        marked: bool = False,
    ) -> Picture:
        """Render the robot's camera at this time (s), uint8 of shape (height, width, 3); blue, green, red.

        `card` is the paint of the card before the camera, `marked` is True if the marker is printed on it.
        """
        picture, depth, eye = self.draw_camera(time, truth, width, height, card, marked)
        return self.apply_water(picture, depth, eye, time)

    def render_observer(
        self,
        time: float,
        truth: Truth,
        view: ObserverView,
        width: int,
        height: int,
        card: Paint | None = None,
    ) -> Picture:
        """Render the view of an observer who follows the robot, as `render_camera`."""
        self._pose(time, truth, card)
        position, axes = view.eye(truth)
        eye = _Eye(position, axes, _camera(view, truth), self._groups(position, card, modelling.ROBOT))
        picture, depth = self._render(eye, width, height)
        seen = self._water.with_visibility(OBSERVER_VISIBILITY)
        return self._optics_for(width, height, OBSERVER_VIEW).apply(
            picture, depth, seen, position, axes, time, noise=0.0
        )

    def draw_camera(
        self,
        time: float,
        truth: Truth,
        width: int,
        height: int,
        card: Paint | None = None,
        marked: bool = False,
    ) -> tuple[Picture, Floats, _Eye]:
        """Return the camera's picture without water, the depth (m) of each pixel, and the point of view."""
        self._pose(time, truth, card)
        axes = rotation(normalize(truth.attitude))
        nose = to_world(axes, (modelling.NOSE, 0.0, 0.0))
        north, east, down = (at + by for at, by in zip(truth.position, nose, strict=True))
        position = (north, east, down)
        printed = (modelling.MARKER_HELD,) if marked else ()
        eye = _Eye(position, axes, self._nose, self._groups(position, card, *printed))
        return *self._render(eye, width, height), eye

    def apply_water(self, picture: Picture, depth: Floats, eye: _Eye, time: float) -> Picture:
        """Return a picture of `draw_camera` as seen through the water."""
        height, width = depth.shape
        return self._optics_for(width, height, modelling.FIELD_OF_VIEW).apply(
            picture, depth, self._water, eye.position, eye.axes, time, NOISE
        )

    def close(self) -> None:
        """Release the memory of OpenGL."""
        if self._gl is not None:
            if self._context is not None:
                self._context.free()
            self._gl.free()
            self._gl = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def _water(self) -> WaterOptics:
        return water(self.contents.kind, self.contents.water.turbidity)

    def _optics_for(self, width: int, height: int, field_of_view: float) -> UnderwaterOptics:
        key = (width, height, field_of_view)
        if key not in self._optics:
            self._optics[key] = UnderwaterOptics(*key)
        return self._optics[key]

    @staticmethod
    def _groups(eye: Vector, card: Paint | None, *more: int) -> tuple[int, ...]:
        """Return the visible groups; the surface only from below: from above it would hide everything."""
        surface = (modelling.SURFACE_BELOW,) if eye[2] > 0 else ()
        held = (modelling.CARD_HELD,) if card else ()
        return (modelling.ALWAYS, *surface, *held, *more)

    def _pose(self, time: float, truth: Truth, card: Paint | None) -> None:
        """Set the pose of the robot and of everything that moves with it."""
        north, east, down = truth.position
        w, x, y, z = truth.attitude
        self._data.qpos[:3] = north, -east, -down
        # Forward, right, down turned into north, east, down is forward, left, up into north, west, up.
        self._data.qpos[3:7] = w, x, -y, -z
        self._data.qpos[7:11] = truth.fins
        ripples = DRIFT * time % modelling.SURFACE_TEXTURE
        self._data.mocap_pos[self._bodies["surface"]] = (
            _snap(north, modelling.SURFACE_TEXTURE) + ripples,
            _snap(-east, modelling.SURFACE_TEXTURE),
            0.0,
        )
        if "ground" in self._bodies:
            self._data.mocap_pos[self._bodies["ground"]] = (
                _snap(north, modelling.PERIOD),
                _snap(-east, modelling.PERIOD),
                0.0,
            )
        if card:
            blue, green, red = card
            self._model.geom_rgba[self._card] = red / 255, green / 255, blue / 255, 1.0

    def _render(self, eye: _Eye, width: int, height: int) -> tuple[Picture, Floats]:
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        self._option.geomgroup[:] = [group in eye.groups for group in range(6)]
        mujoco.mjv_updateScene(
            self._model, self._data, self._option, None, eye.camera, mujoco.mjtCatBit.mjCAT_ALL, self._view
        )
        frame = mujoco.MjrRect(0, 0, width, height)
        self._gl.make_current()
        mujoco.mjr_render(frame, self._view, self._context)
        colours = np.empty((height, width, 3), np.uint8)
        nearness = np.empty((height, width), np.float32)
        mujoco.mjr_readPixels(colours, nearness, frame, self._context)
        # OpenGL counts lines from below, and has red first.
        picture = cv2.cvtColor(cv2.flip(colours, 0), cv2.COLOR_RGB2BGR)
        near, far = modelling.NEAR, modelling.FAR
        depth = np.float32(near * far) / (cv2.flip(nearness, 0) * np.float32(far - near) + np.float32(near))
        return picture.astype(np.uint8, copy=False), depth


def _camera(view: ObserverView, truth: Truth) -> Any:
    """Return MuJoCo's camera of this view. Its azimuth counts from its x axis towards its y axis, west."""
    azimuth, elevation = view.line_of_sight(truth)
    north, east, down = truth.position
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = north, -east, -down
    camera.distance = view.distance
    camera.azimuth, camera.elevation = -degrees(azimuth), -degrees(elevation)
    return camera


def _snap(value: float, period: float) -> float:
    return period * floor(value / period + 0.5)
