"""The craft file: its entries, its refusals, and who takes it."""

from dataclasses import replace
from pathlib import Path

import pytest
import tomli_w

from robot_runtime.config import Config, ControlConfig, CraftConfig, craft_in_force
from robot_runtime.contract.craft import Craft, SensorQuality, craft_table, load_craft, read_craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.control.controllers.predictive import Predictive
from robot_runtime.control.craft_gains import craft_gains, tune_to_craft
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.simulation.water.parameters import SimulationParameters

HEAVY = Craft(mass=3.6, fin_drag=0.2, fin_delay=0.02, gyroscope_offset=(0.01, 0.0, -0.02))
SCENARIO = 'name = "x"\ntitle = "X"\nduration = 5\nscene = { kind = "natural", depth = 3 }\n'


def test_missing_entries_are_the_default_s_also_in_a_sensor_s_table() -> None:
    read = read_craft('title = "T"\n[craft]\nmass = 2\n[craft.accelerometer]\nnoise = 0.03').craft
    assert read == replace(Craft(), mass=2.0, accelerometer=replace(Craft().accelerometer, noise=0.03))
    assert read.accelerometer.bias == Craft().accelerometer.bias != SensorQuality().bias


def test_a_written_craft_is_read_again() -> None:
    craft = replace(HEAVY, pressure=replace(HEAVY.pressure, noise=60.0))
    table = craft_table(craft)
    assert list(table) == ["mass", "fin_drag", "fin_delay", "gyroscope_offset", "pressure"]
    assert read_craft(tomli_w.dumps({"title": "T", "craft": table})).craft == craft


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[craft]\nmass = 3", "title is missing"),
        ('title = ""', "title must be a text of 1 to 100 characters"),
        ('title = "T"\ncraft = 3', "craft must be a table"),
        ('title = "T"\n[craft]\nmass = 30', "craft: mass is 30; it must lie between 0.75 and 12"),
        ('title = "T"\n[craft]\nmass = nan', "craft: mass is nan; it must be a number"),
        ('title = "T"\n[craft]\nweight = 30', "craft: 'weight' is not known here; known are mass, "),
        ('title = "T"\n[craft]\nadded_mass = [1, 1]', "it must be a list of 6 numbers"),
        (
            'title = "T"\n[craft]\nadded_mass = [1, 1, -1, 0, 0, 0]',
            r"added_mass\[2\] is -1; it must lie between 0",
        ),
        ('title = "T"\n[craft.pressure]\nnoise = -1', "a sensor's noise is -1"),
        ("title", "the craft file is not TOML"),
    ],
)
def test_a_wrong_entry_is_refused_with_its_name(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=why):
        load_craft(path)


def test_the_configuration_names_the_craft_else_it_is_the_adopted_one(tmp_path: Path) -> None:
    config, data = tmp_path / "robot.toml", tmp_path / "data"
    assert craft_in_force(Config(), config, data) == Craft()
    data.mkdir()
    (data / "craft.toml").write_text('title = "Adopted"\n[craft]\nmass = 2.5')
    assert craft_in_force(Config(), config, data).mass == 2.5
    named = Config(craft=CraftConfig(file="mine.toml"))
    with pytest.raises(ConfigError, match=r"craft.file is 'mine.toml'; there is no file .*mine.toml"):
        craft_in_force(named, config, data)
    (tmp_path / "mine.toml").write_text('title = "Mine"\n[craft]\nmass = 2')
    assert craft_in_force(named, config, data).mass == 2


def test_a_scenario_takes_the_robot_s_craft_only_where_it_names_it() -> None:
    assert read_scenario(SCENARIO, HEAVY).robot == SimulationParameters()
    named = read_scenario(SCENARIO + 'craft = "robot"\n', HEAVY)
    assert named.robot == SimulationParameters.of(HEAVY)
    changed = read_scenario(SCENARIO + 'craft = "robot"\n[robot]\nbuoyancy = 1.01\n', HEAVY)
    assert changed.robot == replace(SimulationParameters.of(HEAVY), buoyancy=1.01)


def test_the_model_based_controller_gets_the_craft_s_numbers() -> None:
    gains = craft_gains(HEAVY)
    # Less thrust by 0.2 of 0.31; 6.8 kg of moving mass instead of 6.2 kg, of which 3.6 kg float instead of 3.
    lighter = 6.2 / 6.8
    assert gains == pytest.approx(
        {
            "thrust": 0.268 * 0.2 / 0.31 * lighter,
            "drag": 5.65 * lighter,
            "linear": 0.25 * lighter,
            "blade": 2.9 * lighter,
            "centre": 0.045,
            "drift": -0.01 * 1.2 * lighter,
            "noise": 0.0022,
            "lag": 0.05 + 0.02,
            "depth_age": 0.033,
            "acceleration_age": 0.012,
        }
    )
    named = read_scenario(SCENARIO + 'craft = "robot"\n', HEAVY)
    assert named.control.gains["predictive"] == gains


def test_slow_and_noisy_sensors_are_told_to_the_model_based_controller() -> None:
    plain = Craft()
    slow = Craft(
        pressure=replace(plain.pressure, latency=0.1, noise=84.0),
        accelerometer=replace(plain.accelerometer, latency=0.02),
    )
    expected = craft_gains(plain) | {"noise": 0.0044, "depth_age": 0.133, "acceleration_age": 0.027}
    assert craft_gains(slow) == pytest.approx(expected)


def test_gains_of_robot_toml_go_before_those_of_the_craft() -> None:
    mine = ControlConfig(gains={"predictive": {"thrust": 0.3, "noise": 0.004}})
    expected = craft_gains(HEAVY) | {"thrust": 0.3, "noise": 0.004}
    assert tune_to_craft(mine, HEAVY).gains["predictive"] == expected
    assert tune_to_craft(mine, Craft()) == mine


def test_a_craft_at_the_ends_of_its_ranges_gives_gains_within_theirs() -> None:
    still = replace(Craft().pressure, noise=0.0, latency=3.0)
    for extreme in (
        Craft(mass=0.75, fin_drag=1.24, fin_area=0.02, fin_centre=0.18, buoyancy=1.1, pressure=still),
        Craft(mass=12.0, fin_drag=0.03, fin_area=0.001, fin_normal=0.5, buoyancy=0.9),
    ):
        Predictive.check(craft_gains(extreme))
