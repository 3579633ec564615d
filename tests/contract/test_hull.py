"""The reference hull: its budgets add up, it fits the craft, and drawing and page show its numbers."""

import re
from math import radians
from pathlib import Path
from xml.etree import ElementTree

import pytest

from robot_runtime.contract import hull, power_budget
from robot_runtime.contract.buoyancy import RESERVE
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.wiring import PARTS
from robot_runtime.generate.hull import PARTS as NUMBERED
from robot_runtime.generate.hull import hull_page

DRAWING = (Path(__file__).parents[2] / "docs/pictures/hull.svg").read_text(encoding="utf-8")
SVG = "{http://www.w3.org/2000/svg}"
MOTORS = (Path(__file__).parents[2] / "firmware/emulator/motors.c").read_text(encoding="utf-8")


def test_the_trimmed_hull_has_the_reserve_and_is_level() -> None:
    budget = hull.weigh()
    lifted = budget.volume * hull.DESIGN_WATER
    assert sum(part.count * part.mass for part in budget.parts) == pytest.approx(budget.mass)
    assert lifted / budget.mass == pytest.approx(1 + RESERVE)
    forward = sum(part.count * part.mass * part.forward for part in budget.parts) / budget.mass
    outside = sum(part.count * part.outside * part.forward for part in budget.parts) / budget.volume
    assert forward == pytest.approx(outside, abs=1e-6)


def test_the_ballast_fits_on_the_floor_and_is_enough_to_trim_with() -> None:
    ballast = hull.weigh().ballast
    assert 0.2 < ballast.mass < 1.0
    assert hull.ballast_thickness(ballast.mass) < 0.010
    assert abs(ballast.forward) < 0.010


def test_the_hull_is_that_of_the_craft() -> None:
    """Within the spreads that the craft names."""
    craft, budget = Craft(), hull.weigh()
    assert budget.mass == pytest.approx(craft.mass, rel=0.05)
    assert 0.005 <= budget.buoyancy_height <= 0.020
    assert pytest.approx(craft.size) == (hull.LENGTH, 2 * hull.SHAFT_SIDE, hull.HEIGHT)
    assert {tuple(map(abs, position)) for position in craft.fin_positions} == {
        (hull.SHAFT_FORWARD, hull.SHAFT_SIDE)
    }
    assert pytest.approx(budget.centre_down + budget.buoyancy_height, abs=0.002) == hull.SHAFT_DOWN
    lens = hull.LENGTH / 2 + hull.DOME_RING
    assert lens == pytest.approx(0.125), "the simulated camera's place"


def test_every_part_of_the_wiring_has_a_weight_and_draws_or_does_not() -> None:
    titles = {part.title for part in PARTS}
    assert titles <= {part.title for part in hull.list_parts()}
    assert len(titles) - len(power_budget.list_consumers()) == 4, "battery, two regulators, motors"


def test_the_page_s_tables_add_up() -> None:
    page = hull_page()
    for heading in ("## Weight", "## Power"):
        rows = re.findall(r"^\|(.*)\|$", page[page.index(heading) :], re.MULTILINE)[2:]
        cells = [[cell.strip() for cell in row.split("|")] for row in rows]
        total = next(row for row in cells if row[0] == "**in all**")
        parts = cells[: cells.index(total)]
        printed = sum(int(row[1]) for row in parts)
        assert printed == pytest.approx(int(total[1].strip("*")), abs=3)


def test_the_drawing_numbers_every_part_of_the_page() -> None:
    drawing = ElementTree.fromstring(DRAWING)
    texts = [text.text or "" for text in drawing.iter(f"{SVG}text")]
    numbers = {int(text) for text in texts if text.isdigit() and int(text) < 100}
    assert numbers == set(range(1, len(NUMBERED) + 1))
    measures = {1000 * measure for measure in (hull.LENGTH, hull.WIDTH, hull.HEIGHT, 2 * hull.SHAFT_SIDE)}
    assert {round(measure) for measure in measures} == {
        int(text) for text in texts if text.isdigit()
    } - numbers


def test_nothing_of_the_drawing_is_cut_off() -> None:
    drawing = ElementTree.fromstring(DRAWING)
    width, height = (float(drawing.get(name, "")) for name in ("width", "height"))
    for box in drawing.iter(f"{SVG}rect"):
        if box.get("x") is not None and not (box.get("x") or "").startswith("-"):
            x, y, w, h = (float(box.get(name, "0")) for name in ("x", "y", "width", "height"))
            assert min(x, y, width - x - w, height - y - h) >= 0


def test_the_budget_s_motor_is_the_emulated_one() -> None:
    slope, speed = (
        float(re.findall(rf"define {name} ([\d.]+)", MOTORS)[0])
        for name in ("TORQUE_SLOPE", "SPEED_PER_STEP")
    )
    assert pytest.approx(slope, rel=0.01) == power_budget.MOTOR_TORQUE / power_budget.MOTOR_SPEED
    assert pytest.approx(speed, rel=0.05) == power_budget.MOTOR_SPEED * 0.0803 / power_budget.MOTOR_VOLTS
    amperes = float(re.findall(r"define AMPERES_PER_TORQUE ([\d.]+)", MOTORS)[0])
    assert pytest.approx(amperes, rel=0.01) == power_budget.MOTOR_CURRENT / power_budget.MOTOR_TORQUE


def test_a_fin_holds_what_it_can_and_refuses_more() -> None:
    craft = Craft()
    for amplitude in (0.2, 0.8, 1.6):
        thrust = power_budget.flap_thrust(craft, amplitude)
        assert power_budget.flap_amplitude(craft, thrust) == pytest.approx(amplitude)
    with pytest.raises(ValueError, match="a fin cannot push"):
        power_budget.flap_amplitude(craft, 1.0)
    powers = [power_budget.flap_power(craft, amplitude) for amplitude in (0.0, 0.4, 0.8, 1.6)]
    assert powers[0] == 0
    assert powers == sorted(powers)


def test_the_fuse_bears_four_stalled_motors() -> None:
    power = 4 * power_budget.STALL * power_budget.VOLTS / power_budget.EFFICIENCY
    assert (power + power_budget.electronics_power()) / 6.0 < power_budget.FUSE


def test_the_boss_lies_as_the_fin_s_shaft() -> None:
    """Square to the fin at angle 0: 30° off the side, as parts and drawing say."""
    assert Craft().fin_mount == pytest.approx(radians(30), abs=1e-6)
    assert "rotate(60)" in DRAWING
