"""The reference hull: its measures, the mass and place of every part, and the ballast that trims it.

Nobody has built it. Its box is a little narrower than the craft, since bosses carry the fins' shafts, which
are as far apart as the craft is wide. Measures are in m, masses in kg, places forward and down from the
middle of the box. Left and right are alike. Masses are those of the material, of the data sheets, or assumed.
"""

from dataclasses import dataclass
from math import pi

from robot_runtime.contract.buoyancy import GRAVITY, RESERVE, water_density
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.wiring import PARTS

LENGTH, WIDTH, HEIGHT = 0.240, 0.120, 0.100
WALL = 0.008
"""m, of the plates, and of the lid."""
CHAMFER = 0.006
"""m, along the four long edges."""
FRAME = 0.015
"""m, both ways, of the bars under the lid's edge, which take its screws."""
SHAFT_FORWARD, SHAFT_SIDE, SHAFT_DOWN = 0.110, 0.065, 0.010
"""m, of the fins' shafts; down: at the height of the centre of mass."""
BOSS_DIAMETER = 0.024
DOME_RADIUS, DOME_RING, DOME_FLANGE = 0.025, 0.005, 0.030
"""m: a half sphere on a ring of this radius; the lens is in its middle."""
DEPTH_MAX = 3.0
"""m, for which the plates are computed."""
PVC, ACRYLIC, STEEL = 1400.0, 1190.0, 7850.0
"""kg/m³"""
ELASTICITY, POISSON = 3.0e9, 0.38
"""Pa, of PVC and acrylic."""
DESIGN_WATER = water_density(20)
"""kg/m³: fresh water of 20 °C, in which the reserve is set."""

_SMALL_MASS = 0.002
_MASSES = {
    "battery": (0.120, 0.0, 0.024, "two cells of 48 g, holder, protection, fuse"),
    "regulator": (0.004, -0.06, 0.0, "assumed"),
    "motor_regulator": (0.008, -0.06, 0.0, "assumed"),
    "pi": (0.014, 0.02, -0.01, "with its card, assumed"),
    "pressure": (0.020, 0.0, -0.045, "with its thread and cable, assumed"),
    "encoder": (0.004, 0.0, SHAFT_DOWN, "on its board, assumed"),
    "motor": (0.010, 0.0, SHAFT_DOWN, "data sheet"),
    "detector": (0.005, 0.10, 0.0, "assumed"),
}
"""kg, forward, down and origin; four alike stand for their middle. Others are small and in the middle."""


@dataclass(frozen=True)
class HullPart:
    """Parts of one kind: the mass of each, the water that each displaces outside the box, their middle."""

    title: str
    count: int
    mass: float
    forward: float
    down: float
    origin: str
    outside: float = 0.0
    """m³"""


@dataclass(frozen=True)
class WeightBudget:
    """All parts with the ballast, and what follows from them."""

    parts: tuple[HullPart, ...]
    volume: float
    """m³ that the closed robot displaces."""
    mass: float
    ballast: HullPart
    centre_down: float
    """m from the middle of the box down to the centre of buoyancy."""
    buoyancy_height: float
    """m from the centre of mass up to the centre of buoyancy."""


def list_parts() -> list[HullPart]:
    """Return every part of the robot but the ballast."""
    return [*_shell(), *_outside(), *_inside(), *_electronics()]


def weigh() -> WeightBudget:
    """Return the budget with the ballast that leaves the reserve and levels the hull."""
    parts = list_parts()
    box = LENGTH * WIDTH * HEIGHT - 4 * CHAMFER**2 / 2 * LENGTH
    volume = box + sum(part.count * part.outside for part in parts)
    mass = volume * DESIGN_WATER / (1 + RESERVE)
    dry = sum(part.count * part.mass for part in parts)
    # Buoyancy acts in the middle of the displaced water: that of the box, and of what stands out.
    centre_forward = sum(part.count * part.outside * part.forward for part in parts) / volume
    centre_down = sum(part.count * part.outside * part.down for part in parts) / volume
    moment = sum(part.count * part.mass * part.forward for part in parts)
    weight = mass - dry
    thickness = ballast_thickness(weight)
    ballast = HullPart(
        "ballast, steel plate on the floor",
        1,
        weight,
        (mass * centre_forward - moment) / weight,
        HEIGHT / 2 - WALL - thickness / 2,
        "what is left",
    )
    down = sum(part.count * part.mass * part.down for part in (*parts, ballast)) / mass
    return WeightBudget((*parts, ballast), volume, mass, ballast, centre_down, down - centre_down)


def squeeze(depth: float) -> float:
    """Return the m³ by which lid and floor give way at this depth (m), as if only laid on their edges.

    A plate twice as long as wide sags by about 0.0105·q·b⁴/D in the middle (S. Timoshenko and S.
    Woinowsky-Krieger, Theory of Plates and Shells, 1959, table 8), and by 4/π² of that in the mean.
    """
    stiffness = ELASTICITY * WALL**3 / (12 * (1 - POISSON**2))
    pressure = DESIGN_WATER * GRAVITY * depth
    spans = ((LENGTH - 2 * WALL, WIDTH - 2 * WALL), opening())
    return sum(0.405 * 0.0105 * pressure * b**4 / stiffness * a * b for a, b in spans)


def plate_stress(depth: float) -> float:
    """Return the largest stress, Pa, in the floor at this depth (m): 0.62·q·b²/t², laid on its edges."""
    return 0.62 * DESIGN_WATER * GRAVITY * depth * ((WIDTH - 2 * WALL) / WALL) ** 2


def ballast_thickness(mass: float) -> float:
    """Return the m of a steel plate of this mass that fills the floor below the opening."""
    length, width = opening()
    return mass / STEEL / (length * width)


def opening() -> tuple[float, float]:
    """Return length and width of the opening under the lid."""
    return LENGTH - 2 * WALL - 2 * FRAME, WIDTH - 2 * WALL - 2 * FRAME


def _shell() -> list[HullPart]:
    tall = HEIGHT - WALL
    inner = (LENGTH - 2 * WALL) * (WIDTH - 2 * WALL) * (tall - WALL)
    outer = LENGTH * WIDTH * tall
    edges = CHAMFER**2 * LENGTH
    tray = outer - inner - edges
    clear = opening()
    frame = ((LENGTH - 2 * WALL) * (WIDTH - 2 * WALL) - clear[0] * clear[1]) * FRAME
    return [
        HullPart("tray, PVC plates", 1, tray * PVC, 0.0, outer * WALL / 2 / tray, "its volume"),
        HullPart("frame, PVC bars", 1, frame * PVC, 0.0, -HEIGHT / 2 + WALL + FRAME / 2, "its volume"),
        HullPart(
            "lid, acrylic",
            1,
            (LENGTH * WIDTH * WALL - edges) * ACRYLIC,
            0.0,
            -HEIGHT / 2 + WALL / 2,
            "its volume",
        ),
        HullPart("lid's screws and inserts", 16, 0.003, 0.0, -0.042, "assumed"),
        HullPart("lid's cord", 1, 0.006, 0.0, -0.042, "its volume"),
    ]


def _outside() -> list[HullPart]:
    front = LENGTH / 2
    dome = 2 / 3 * pi * DOME_RADIUS**3 + pi * DOME_FLANGE**2 * DOME_RING
    craft = Craft()
    blade = craft.fin_area * 0.003
    return [
        HullPart("dome with ring", 1, 0.030, front + 0.010, 0.0, "its volume", dome),
        HullPart("boss", 4, 0.016, 0.0, SHAFT_DOWN, "its volume", 3e-6),
        HullPart("fin, 3 mm of rubber", 4, blade * 1150, 0.0, SHAFT_DOWN, "its volume", blade),
        HullPart("fin's clamp and screw", 4, 0.008, 0.0, SHAFT_DOWN, "assumed", 2e-6),
        HullPart("switch and vent plug", 2, 0.015, -front, 0.0, "assumed", 3e-6),
    ]


def _inside() -> list[HullPart]:
    return [
        HullPart("shaft, bearings, seals, gears", 4, 0.014, 0.0, SHAFT_DOWN, "assumed"),
        HullPart("camera and its mount", 1, 0.012, 0.11, 0.0, "assumed"),
        HullPart("carrier plate", 1, 0.080, 0.0, 0.0, "assumed"),
        HullPart("wires and connectors", 1, 0.060, 0.0, 0.0, "assumed"),
    ]


def _electronics() -> list[HullPart]:
    small = (_SMALL_MASS, 0.0, 0.0, "assumed")
    return [HullPart(part.title, part.count, *_MASSES.get(part.name, small)) for part in PARTS]
