"""The craft file: its entries, its refusals, and who takes it."""

from dataclasses import replace
from pathlib import Path

import pytest
import tomli_w

from robot_runtime.config import Config, ControlConfig, CraftConfig, craft_in, craft_path
from robot_runtime.contract.craft import Craft, SensorQuality, craft_table, load_craft, read_craft
from robot_runtime.contract.limits import ConfigError
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
    assert craft_in(craft_path(Config(), config, data)) == Craft()
    data.mkdir()
    (data / "craft.toml").write_text('title = "Adopted"\n[craft]\nmass = 2.5')
    assert craft_in(craft_path(Config(), config, data)).mass == 2.5
    named = Config(craft=CraftConfig(file="mine.toml"))
    with pytest.raises(ConfigError, match=r"craft.file is 'mine.toml'; there is no file .*mine.toml"):
        craft_path(named, config, data)
    (tmp_path / "mine.toml").write_text('title = "Mine"\n[craft]\nmass = 2')
    assert craft_in(craft_path(named, config, data)).mass == 2


def test_a_scenario_takes_the_robot_s_craft_only_where_it_names_it() -> None:
    assert read_scenario(SCENARIO, HEAVY).robot == SimulationParameters()
    named = read_scenario(SCENARIO + 'craft = "robot"\n', HEAVY)
    assert named.robot == SimulationParameters.of(HEAVY)
    changed = read_scenario(SCENARIO + 'craft = "robot"\n[robot]\nbuoyancy = 1.01\n', HEAVY)
    assert changed.robot == replace(SimulationParameters.of(HEAVY), buoyancy=1.01)


def test_the_model_based_controller_gets_the_craft_s_thrust_and_drag() -> None:
    gains = craft_gains(HEAVY)
    # Less thrust by 0.2 of 0.31, on 6.8 kg of moving mass instead of 6.2 kg.
    assert gains == pytest.approx({"thrust": 0.268 * 0.2 / 0.31 * 6.2 / 6.8, "drag": 35 / 6.8})
    named = read_scenario(SCENARIO + 'craft = "robot"\n', HEAVY)
    assert named.control.gains["predictive"] == gains
    mine = ControlConfig(gains={"predictive": {"thrust": 0.3}})
    assert tune_to_craft(mine, HEAVY).gains["predictive"] == {"thrust": 0.3, "drag": gains["drag"]}
    assert tune_to_craft(mine, Craft()) == mine
