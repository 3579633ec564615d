"""robot.toml: the shipped file holds the defaults, and errors are named."""

from pathlib import Path

import pytest

from robot_runtime.config import Config, load
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.control.controllers import CONTROLLERS
from robot_runtime.control.craft_gains import craft_gains

SHIPPED = Path(__file__).resolve().parents[2] / "robot.toml"


def test_the_shipped_file_holds_the_defaults() -> None:
    shipped, plain = load(SHIPPED), Config()
    assert (shipped.robot, shipped.link, shipped.zenoh) == (plain.robot, plain.link, plain.zenoh)
    assert (shipped.control.rate, shipped.control.controller) == (
        plain.control.rate,
        plain.control.controller,
    )
    defaults = {
        cls.name: {name: limits.default for name, limits in cls.limits.items()}
        for cls in CONTROLLERS["depth"]
    }
    # Those of the craft are not set, so that another craft has its own.
    of_the_craft = {name: defaults["predictive"].pop(name) for name in craft_gains(Craft())}
    assert craft_gains(Craft()) == pytest.approx(of_the_craft, rel=0.002)
    assert shipped.control.gains == defaults


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[robot]\nnmae = 'x'", r"robot: 'nmae' is not known here; known are name, mode"),
        ("[robot]\nmode = 'pool'", r"mode is 'pool'; it must be one of 'emulated', 'robot'"),
        ("[link]\nbaud = 300", "between 1200 and 500000"),
        ("[link]\nbaud = 230400", r"link.baud is 230400; the chip at 16 MHz makes 222222 of it, -3.5%"),
        ("[link]\nbaud = '250000'", "must be a whole number"),
        ("[zenoh]\nlisten = ['tcp/0.0.0.0:7447']", r"the whole network command .* \"tls/ADDRESS:PORT\""),
        ("[zenoh]\nlisten = ['tls/0.0.0.0:7447#enable_mtls=false']", "the whole network command"),
        ("[zenoh]\nlisten = ['tls/[::]:7447', 'quic/0.0.0.0:7448']", "zenoh.listen has 'quic/0.0.0.0:7448'"),
        ("[vision]\nwidth = 1920", "vision.width is 1920; the scene draws 1280 at most"),
        ("[control]\nrate = 5", "must lie between 10 and 50"),
        ("[control]\nrate = nan", "must be a number"),
        ("[control]\nrate = true", "must be a number"),
        ("[control.gains.pid]\nkp = 'much'", r"gains.pid.kp is 'much'"),
        ("robot = 3", "must be a table"),
        ("[robot", "cannot be read"),
    ],
)
def test_errors_are_named(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=why):
        load(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"robot\.toml cannot be read"):
        load(tmp_path / "robot.toml")


def test_whole_numbers_serve_as_numbers() -> None:
    assert parse(Config, {"control": {"rate": 20}}).control.rate == 20.0
