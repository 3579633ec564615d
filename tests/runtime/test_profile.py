"""The profile of a computer with little processor time."""

from dataclasses import replace

import pytest

from robot_runtime.config import Config, LinkConfig, RobotConfig, VisionConfig
from robot_runtime.profile import Profile, choose_profile, fit, in_step

ZERO_W = (1, 447_000_000)
ZERO_2_W = (4, 447_000_000)
SMALL_SERVER = (1, 2_000_000_000)


@pytest.mark.parametrize(
    ("computer", "profile"), [(ZERO_W, "lean"), (ZERO_2_W, "full"), (SMALL_SERVER, "full")]
)
def test_it_is_chosen_by_the_computer(computer: tuple[int, int], profile: Profile) -> None:
    assert choose_profile(Config(), *computer) == profile


@pytest.mark.parametrize("profile", ["full", "lean"])
def test_a_profile_of_the_configuration_is_taken(profile: Profile) -> None:
    config = Config(robot=RobotConfig(profile=profile))
    assert choose_profile(config, *ZERO_W) == choose_profile(config, *SMALL_SERVER) == profile


def test_the_full_one_leaves_everything_as_it_is() -> None:
    config = Config()
    assert fit(config, "full") == replace(config, robot=RobotConfig(profile="full"))


def test_the_lean_one_has_fewer_and_smaller_pictures() -> None:
    lean = fit(Config(vision=VisionConfig(width=640, height=360)), "lean")
    assert lean.robot.profile == "lean"
    assert (lean.vision.width, lean.vision.height, lean.vision.rate) == (160, 90, 2.0)
    assert lean.control == Config().control


def test_the_lean_one_enlarges_nothing() -> None:
    vision = VisionConfig(width=100, height=80, rate=0.5, stream_width=200, stream_rate=2.0)
    assert fit(Config(vision=vision), "lean").vision == vision


@pytest.mark.parametrize(
    ("config", "expected"),
    [
        (Config(robot=RobotConfig(profile="lean")), True),
        (Config(robot=RobotConfig(profile="full")), False),
        (Config(robot=RobotConfig(profile="lean", mode="hil")), False),
        (Config(robot=RobotConfig(profile="lean"), link=LinkConfig(baud=1200)), False),
    ],
    ids=["lean", "full", "in the loop", "slow line"],
)
def test_only_the_lean_one_hears_the_board_in_step_with_control(config: Config, expected: bool) -> None:
    assert in_step(config) is expected
