"""The default craft's numbers fit together: it can float, and its water is that of a body of its size."""

from math import pi

import pytest
from scipy.special import elliprd

from robot_runtime.contract.craft import Craft
from robot_runtime.simulation.water.parameters import SimulationParameters

CRAFT = Craft()
LENGTH, WIDTH, HEIGHT = CRAFT.size
HALVES = LENGTH / 2, WIDTH / 2, HEIGHT / 2
DENSITY = 1000.0
PLATE = pi / 4 * DENSITY * 0.05**2 * 0.09
"""kg of water that moves along with one fin across its blade, of 9 cm by 5 cm."""
SIDEWAYS, UPWARDS, AHEAD = 1.60, 1.45, 0.35
"""Coefficients of boxes with these proportions (DNV-RP-H103, 2011, tables A-1 and A-2)."""


def ellipsoid() -> tuple[float, ...]:
    """Added mass and inertia of the ellipsoid within the hull (H. Lamb, Hydrodynamics, 1932, 114 and 121)."""
    a, b, c = (half**2 for half in HALVES)
    product = HALVES[0] * HALVES[1] * HALVES[2]
    mass = 4 / 3 * pi * product * DENSITY
    shapes = [2 / 3 * product * float(elliprd(*sides)) for sides in ((b, c, a), (a, c, b), (a, b, c))]

    def turning(p: float, q: float, x: float, y: float) -> float:
        return mass / 5 * (p - q) ** 2 * (y - x) / (2 * (p - q) + (p + q) * (x - y))

    x, y, z = shapes
    return (
        *(shape / (2 - shape) * mass for shape in shapes),
        turning(b, c, y, z),
        turning(a, c, x, z),
        turning(a, b, x, y),
    )


def box_with_fins() -> tuple[float, ...]:
    """Added mass and inertia of strips of the box, whose ends lose nothing, and of four plates."""
    sideways = SIDEWAYS * pi * HALVES[2] ** 2 * DENSITY
    upwards = UPWARDS * pi * HALVES[1] ** 2 * DENSITY
    return (
        AHEAD * LENGTH * WIDTH * HEIGHT * DENSITY,
        sideways * LENGTH,
        upwards * LENGTH + 4 * PLATE,
        4 * PLATE * (0.065 + 0.0225) ** 2,
        upwards * LENGTH**3 / 12 + 4 * PLATE * 0.071**2,
        sideways * LENGTH**3 / 12,
    )


def test_the_hull_holds_the_water_that_it_displaces() -> None:
    """More than an ellipsoid within it, less than all of it; a hull of 10 cm width cannot carry 3 kg."""
    box = LENGTH * WIDTH * HEIGHT
    assert 0.9 * box < CRAFT.volume < box
    assert CRAFT.volume > LENGTH * 0.10 * HEIGHT
    assert pytest.approx(CRAFT.mass * CRAFT.buoyancy / DENSITY) == CRAFT.volume


def test_the_hull_reaches_to_the_shafts_of_its_fins() -> None:
    assert {abs(right) for _, right in CRAFT.fin_positions} == {WIDTH / 2}
    assert all(abs(forward) < LENGTH / 2 for forward, _ in CRAFT.fin_positions)


def test_its_inertia_is_that_of_an_even_box() -> None:
    x, y, z = (side**2 for side in CRAFT.size)
    even = [CRAFT.mass / 12 * two for two in (y + z, x + z, x + y)]
    assert pytest.approx(even, rel=0.01) == CRAFT.inertia


def test_its_added_mass_lies_between_an_ellipsoid_s_and_that_of_a_box_with_fins() -> None:
    for low, value, high in zip(ellipsoid(), CRAFT.added_mass, box_with_fins(), strict=True):
        assert low < value < high


def test_drag_is_that_of_a_blunt_body() -> None:
    """Coefficients on the projected areas: 1 for a box, and up to 2.3 with what stands out from it."""
    areas = (WIDTH * HEIGHT, LENGTH * HEIGHT, LENGTH * WIDTH)
    for drag, area in zip(CRAFT.damping_quadratic, areas, strict=False):
        assert 1.0 < drag / (0.5 * DENSITY * area) < 2.3


def test_what_moves_is_what_moved_in_the_published_simulations() -> None:
    """Masses with the water that moves along: the thesis's figures and all gains were made with them."""
    assert CRAFT.total_mass == pytest.approx((3.9, 5.6, 6.2, 0.009, 0.0289, 0.0269))
    assert SimulationParameters().weight == pytest.approx(29.43)
