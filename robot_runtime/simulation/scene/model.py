"""The scene as a MuJoCo model. MuJoCo's axes here are north, west, up, and forward, left, up in the body."""

import os
from math import cos, pi, sin
from typing import Any

# MuJoCo reads this when it is imported.
os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np

from robot_runtime.simulation.scene import shapes, textures
from robot_runtime.simulation.scene.contents import Contents
from robot_runtime.simulation.scene.water import water
from robot_runtime.simulation.water.parameters import SimulationParameters

WIDTH_MAX, HEIGHT_MAX = 1280, 960
FIELD_OF_VIEW = 48.8
"""°, vertical. Pi Camera v2 by its data sheet; assumed behind a dome, as a flat window would narrow it."""
NOSE = 0.125
"""m from the centre of mass forward to the camera."""
CARD_DISTANCE = 0.4
"""m from camera to card."""
CARD = (0.105, 0.148)
"""m, width and height: A6."""
MARKER_SIDE = 0.8
"""Width of the marker as a share of the card's."""
NEAR, FAR = 0.02, 1000.0
"""m, limits of the drawn distances."""

ALWAYS, ROBOT, SURFACE_BELOW, CARD_HELD, MARKER_HELD = range(5)
"""Groups of geometry that depend on the viewer and its position."""

PERIOD = 10.0
"""m, period of the natural floor."""
RELIEF = 0.35
"""m between the highest and the lowest places of the natural floor; the highest is the simulator's floor."""
RELIEF_SIDE = 49
STONES, PLANTS = 26, 34
"""Number of each in every period of the floor."""
TILE_TEXTURE = 1.2
"""m that one tile texture covers, with 8 x 8 tiles."""
LINE_WIDTH, LINE_APART = 0.25, 2.5
"""m, of the dark lines on a pool's floor."""
POOL_MAX = 60.0
"""m; nothing farther is visible."""
SURFACE = 30.0
"""m of surface on each side of the robot."""
SURFACE_TEXTURE = 1.8
"""m that one texture of the surface covers."""

_M = mujoco
_T2D, _TCUBE = _M.mjtTexture.mjTEXTURE_2D, _M.mjtTexture.mjTEXTURE_CUBE
_PLANE, _BOX, _BALL = _M.mjtGeom.mjGEOM_PLANE, _M.mjtGeom.mjGEOM_BOX, _M.mjtGeom.mjGEOM_SPHERE
_ELLIPSOID, _CAPSULE = _M.mjtGeom.mjGEOM_ELLIPSOID, _M.mjtGeom.mjGEOM_CAPSULE
_MESH, _HFIELD = _M.mjtGeom.mjGEOM_MESH, _M.mjtGeom.mjGEOM_HFIELD


def build(contents: Contents, parameters: SimulationParameters) -> Any:
    """Return the compiled model (MjModel) of this scene with the robot in it."""
    spec = mujoco.MjSpec()
    spec.stat.extent = 1.0
    spec.visual.map.znear, spec.visual.map.zfar = NEAR, FAR
    spec.visual.global_.offwidth, spec.visual.global_.offheight = WIDTH_MAX, HEIGHT_MAX
    # Several samples a pixel take a CPU three times as long; the blur of the optics smooths edges instead.
    spec.visual.quality.offsamples = 0
    spec.visual.quality.shadowsize = 16
    spec.visual.quality.numslices, spec.visual.quality.numstacks = 24, 16
    spec.visual.headlight.ambient = [0.5, 0.5, 0.5]
    spec.visual.headlight.diffuse = [0.3, 0.3, 0.3]
    spec.visual.headlight.specular = [0.0, 0.0, 0.0]
    world = spec.worldbody
    world.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        dir=[0.25, 0.2, -1.0],
        pos=[0, 0, 5],
        castshadow=False,
        ambient=[0, 0, 0],
        diffuse=[0.25, 0.25, 0.25],
        specular=[0.25, 0.25, 0.25],
    )
    _surface(spec, contents)
    (_pool if contents.kind == "pool" else _natural)(spec, contents)
    _targets_and_beacons(spec, contents)
    _robot(spec, parameters)
    return spec.compile()


def _texture(spec: Any, name: str, pixels: textures.Texture, repeat: float = 1.0, **more: Any) -> str:
    """Add a material with this texture, `repeat` times per m, or once over the whole object."""
    kind = more.pop("type", _T2D)
    texture = spec.add_texture(name=name, type=kind, nchannel=pixels.shape[2])
    texture.width, texture.height = pixels.shape[1], pixels.shape[0]
    texture.data = pixels.tobytes()
    material = spec.add_material(name=name, texuniform=repeat != 1.0, **more)
    material.texrepeat = [repeat, repeat]
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    return name


def _surface(spec: Any, contents: Contents) -> None:
    blue, green, red = water(contents.kind, contents.water.turbidity).glow
    glow = (round(red), round(green), round(blue))
    below = _texture(spec, "below", textures.surface_below(glow), 1 / SURFACE_TEXTURE, emission=0.9)
    body = spec.worldbody.add_body(name="surface", mocap=True)
    # Turned over, because a plane is visible from the side of its z axis.
    body.add_geom(
        type=_PLANE, size=[SURFACE, SURFACE, 1], quat=[0, 1, 0, 0], material=below, group=SURFACE_BELOW
    )


def _pool(spec: Any, contents: Contents) -> None:
    basin = contents.basin
    north = min(basin.length or POOL_MAX, POOL_MAX) / 2
    west = min(basin.width or POOL_MAX, POOL_MAX) / 2
    tiles = _texture(spec, "tiles", textures.tiles(), 1 / TILE_TEXTURE, specular=0.3, shininess=0.5)
    world, depth = spec.worldbody, basin.depth
    world.add_geom(type=_PLANE, size=[north, west, 1], pos=[0, 0, -depth], material=tiles)
    high = depth / 2
    for sign in (1, -1):
        # The z axis, a plane's visible side, points inwards; the y axis is the wall's height.
        world.add_geom(
            type=_PLANE, size=[west, high, 1], pos=[sign * north, 0, -high], material=tiles,
            quat=_axes((0, -sign, 0), (0, 0, 1)),
        )  # fmt: skip
        world.add_geom(
            type=_PLANE, size=[north, high, 1], pos=[0, sign * west, -high], material=tiles,
            quat=_axes((sign, 0, 0), (0, 0, 1)),
        )  # fmt: skip
    dark = [0.05, 0.07, 0.1, 1.0]
    thin = 0.002
    lines = max(int((2 * west - 1.0) // LINE_APART), 1)
    for line in range(lines):
        across = (line - (lines - 1) / 2) * LINE_APART
        end = max(north - 0.8, 0.3)
        world.add_geom(type=_BOX, size=[end, LINE_WIDTH / 2, thin], pos=[0, across, -depth], rgba=dark)
        for sign in (1, -1):
            world.add_geom(
                type=_BOX, size=[LINE_WIDTH / 2, 0.5, thin], pos=[sign * end, across, -depth], rgba=dark
            )
            world.add_geom(
                type=_BOX, size=[thin, LINE_WIDTH / 2, 0.3 * depth], pos=[sign * north, across, -depth / 2],
                rgba=dark,
            )  # fmt: skip


def _natural(spec: Any, contents: Contents) -> None:
    sand = _texture(spec, "sand", textures.sand(), 1 / (PERIOD / 4))
    _texture(spec, "stone", textures.stone(), type=_TCUBE)
    ground = spec.worldbody.add_body(name="ground", mocap=True)
    tile = textures.relief(RELIEF_SIDE)
    wide = np.tile(tile[:-1, :-1], (2, 2))
    wide = np.pad(wide, ((0, 1), (0, 1)), mode="wrap")
    spec.add_hfield(
        name="relief", nrow=wide.shape[0], ncol=wide.shape[1], size=[PERIOD, PERIOD, RELIEF, 0.1],
        userdata=wide.ravel().tolist(),
    )  # fmt: skip
    bottom = -contents.basin.depth - RELIEF
    ground.add_geom(type=_HFIELD, hfieldname="relief", pos=[0, 0, bottom], material=sand)
    ground.add_geom(type=_PLANE, size=[60, 60, 1], pos=[0, 0, bottom + 0.4 * RELIEF], material=sand)
    for number in range(shapes.KINDS):
        _mesh(spec, f"stone{number}", *shapes.stone(number))
        _mesh(spec, f"plant{number}", *shapes.plant(number))
    rng = np.random.default_rng(20)

    def height(x: float, y: float) -> float:
        column, row = ((value + PERIOD) / PERIOD % 1.0 * (RELIEF_SIDE - 1) for value in (x, y))
        return bottom + RELIEF * float(tile[round(row), round(column)])

    for number in range(STONES + PLANTS):
        stone = number < STONES
        x, y = rng.uniform(-PERIOD / 2, PERIOD / 2, 2)
        turn, shade = rng.uniform(0, 2 * pi), rng.uniform(0.8, 1.2)
        rgba = [shade, shade, shade, 1] if stone else [0.24 * shade, 0.23 * shade, 0.2 * shade, 1]
        for north, west in ((x, y) for x in (-PERIOD, 0.0) for y in (-PERIOD, 0.0)):
            ground.add_geom(
                type=_MESH,
                meshname=f"{'stone' if stone else 'plant'}{number % shapes.KINDS}",
                pos=[x + north, y + west, height(x, y)],
                quat=[cos(turn / 2), 0, 0, sin(turn / 2)],
                material="stone" if stone else "",
                rgba=rgba,
            )


def _targets_and_beacons(spec: Any, contents: Contents) -> None:
    floor = -contents.basin.depth
    line = [0.25, 0.27, 0.28, 1]
    for target in contents.targets:
        north, east, down = target.position
        blue, green, red = target.paint
        half = target.size / 2
        spec.worldbody.add_geom(
            type=_BALL if target.shape == "ball" else _BOX,
            size=[half, half, half], pos=[north, -east, -down],
            quat=[cos(0.3), 0, 0, sin(0.3)], rgba=[red / 255, green / 255, blue / 255, 1],
        )  # fmt: skip
        _rope(spec, north, east, down + half, floor, line)
    for number, (north, east, down) in enumerate(contents.beacons):
        material = spec.add_material(name=f"beacon{number}", emission=1.0, rgba=[1, 1, 0.94, 1])
        spec.worldbody.add_geom(
            type=_BALL, size=[0.035, 0.035, 0.035], pos=[north, -east, -down], material=material.name
        )
        spec.worldbody.add_geom(
            type=_M.mjtGeom.mjGEOM_CYLINDER, size=[0.03, 0.04, 0], pos=[north, -east, -down - 0.065],
            rgba=[0.12, 0.13, 0.14, 1],
        )  # fmt: skip
        _rope(spec, north, east, down + 0.1, floor, line)


def _robot(spec: Any, parameters: SimulationParameters) -> None:
    length, width, height = (side / 2 for side in parameters.size)
    robot = spec.worldbody.add_body(name="robot")
    robot.add_freejoint()
    shell, dark, fin = [0.96, 0.72, 0.14, 1], [0.1, 0.12, 0.14, 1], [0.16, 0.19, 0.22, 1]
    spec.add_material(name="shell", rgba=shell, specular=0.5, shininess=0.6)
    robot.add_geom(type=_ELLIPSOID, size=[length, width, height], material="shell", group=ROBOT)
    robot.add_geom(
        type=_ELLIPSOID, size=[0.9 * length, 0.93 * width, 0.9 * height], pos=[0, 0, -0.011], rgba=dark,
        group=ROBOT,
    )  # fmt: skip
    robot.add_geom(type=_BALL, size=[0.024, 0, 0], pos=[length - 0.018, 0, 0], rgba=[0.03, 0.04, 0.05, 1],
                   group=ROBOT)  # fmt: skip
    robot.add_geom(
        type=_ELLIPSOID, size=[0.045, 0.018, 0.006], pos=[-0.01, 0, height], rgba=dark, group=ROBOT
    )
    robot.add_camera(name="nose", pos=[NOSE, 0, 0], quat=_axes((0, -1, 0), (0, 0, 1)), fovy=FIELD_OF_VIEW)
    robot.add_geom(
        name="card", type=_BOX, size=[0.001, CARD[0] / 2, CARD[1] / 2],
        pos=[NOSE + CARD_DISTANCE, 0, 0], group=CARD_HELD,
    )  # fmt: skip
    # A texture lies across a box's z axis, which points to the camera.
    marker = _texture(spec, "marker", textures.marker())
    half = MARKER_SIDE * CARD[0] / 2
    robot.add_geom(
        type=_BOX, size=[half, half, 0.0005], pos=[NOSE + CARD_DISTANCE - 0.002, 0, 0],
        quat=_axes((0, -1, 0), (0, 0, 1)), material=marker, group=MARKER_HELD,
    )  # fmt: skip
    places = zip(parameters.fin_positions, parameters.fin_directions, strict=True)
    for number, ((forward, right), (along, across)) in enumerate(places):
        body = robot.add_body(pos=[forward, -right, 0], quat=_axes((along, -across, 0), (across, along, 0)))
        # Across the blade, so that its tip goes down with a growing angle.
        body.add_joint(name=f"fin{number}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 1, 0])
        body.add_geom(type=_ELLIPSOID, size=[0.054, 0.023, 0.004], pos=[0.042, 0, 0], rgba=fin, group=ROBOT)
        body.add_geom(type=_BALL, size=[0.011, 0, 0], rgba=dark, group=ROBOT)


def _mesh(spec: Any, name: str, vertices: shapes.Vertices, faces: shapes.Faces) -> None:
    mesh = spec.add_mesh(name=name, uservert=vertices.ravel().tolist(), userface=faces.ravel().tolist())
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL


def _rope(spec: Any, north: float, east: float, down: float, floor: float, rgba: list[float]) -> None:
    if -down > floor:
        spec.worldbody.add_geom(
            type=_CAPSULE, fromto=[north, -east, -down, north, -east, floor], size=[0.004, 0, 0], rgba=rgba
        )


def _axes(x: tuple[float, float, float], y: tuple[float, float, float]) -> list[float]:
    """Return the quaternion of a frame with these x and y axes."""
    quaternion = np.empty(4)
    frame = np.column_stack((x, y, np.cross(x, y))).astype(float)
    mujoco.mju_mat2Quat(quaternion, frame.ravel())
    return quaternion.tolist()
