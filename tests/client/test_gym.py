"""The environments of Gymnasium: the robot's own firmware in simulated water."""

import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import mucat.gym
from mucat.gym.environment import OBSERVED, Numbers
from tests.documents.blocks import read_blocks

HOVER = "mucat/HoverInACurrent-v0"
gymnasium.register_envs(mucat.gym)
REST = np.zeros(6, np.float32)
LEAK = """
name = "leak"
title = "A leak"
duration = 10
[scene]
kind = "natural"
depth = 4.0
[control]
set_point = 0.5
[[events]]
at = 2
do = "set_points"
default = 1.5
[[events]]
at = 3
do = "fault"
sensor = "leak"
kind = "wet"
"""


def swim(seed: int, count: int) -> list[tuple[Numbers, float, dict[str, Any]]]:
    """Return what comes of so many steps by chance."""
    env = gymnasium.make(HOVER, duration=20)
    env.action_space.seed(seed)
    results: list[tuple[Numbers, float, dict[str, Any]]] = [(env.reset(seed=seed)[0], 0.0, {})]
    for _ in range(count):
        observation, reward, _, _, info = env.step(env.action_space.sample())
        results.append((observation, float(reward), info))
    env.close()
    return results


def test_gymnasium_s_own_check_passes() -> None:
    check_env(gymnasium.make(HOVER, duration=3).unwrapped)


def test_the_same_seed_and_actions_give_the_same_observations_to_the_bit() -> None:
    first, again, other = swim(3, 30), swim(3, 30), swim(4, 30)
    assert [step[0].tobytes() for step in first] == [step[0].tobytes() for step in again]
    assert [step[1:] for step in first] == [step[1:] for step in again]
    assert first[0][0].tobytes() != other[0][0].tobytes()


def test_two_robots_in_one_process_do_not_disturb_each_other() -> None:
    alone = swim(5, 10)
    env, other = gymnasium.make(HOVER, duration=20), gymnasium.make(HOVER, duration=20)
    env.action_space.seed(5)
    observations = [env.reset(seed=5)[0]]
    other.reset(seed=6)
    for _ in range(10):
        observations.append(env.step(env.action_space.sample())[0])
        other.step(REST)
    env.close()
    other.close()
    assert [step[0].tobytes() for step in alone] == [observation.tobytes() for observation in observations]


def test_a_robot_at_rest_floats_and_one_that_is_driven_down_is_rewarded() -> None:
    env = gymnasium.make(HOVER, duration=8)
    env.reset(seed=1)
    down = np.array([0, 0, 1, 0, 0, 0], np.float32)
    rewards: list[float] = []
    over = False
    while not over:
        observation, reward, terminated, over, info = env.step(down if len(rewards) >= 30 else REST)
        assert not terminated
        rewards.append(float(reward))
    env.close()
    assert len(rewards) == 70
    assert info["time"] == 8.0
    assert rewards[29] == pytest.approx(0.2, abs=0.1), "it floats 0.8 m above its set point"
    assert max(rewards[30:]) > 0.6
    named = dict(zip((number.name for number in OBSERVED), observation, strict=True))
    assert named["set_point"] == pytest.approx(0.8)
    assert named["depth"] == pytest.approx(info["position"][2], abs=0.1)
    assert np.linalg.norm(observation[2:6]) == pytest.approx(1, abs=0.01)


def test_events_of_the_water_happen_and_a_robot_that_stops_itself_ends_the_episode() -> None:
    env = gymnasium.make("mucat/Scenario-v0", scenario=LEAK)
    observation, _ = env.reset(seed=1)
    assert observation[1] == pytest.approx(0.5)
    terminated = truncated = False
    while not terminated and not truncated:
        observation, reward, terminated, truncated, info = env.step(REST)
    env.close()
    assert terminated
    assert 3 < info["time"] < 4
    assert "water in the hull" in info["stopped"]
    assert observation[1] == pytest.approx(1.5)
    assert reward == 0.0, "it is more than a metre above the set point"


def test_what_cannot_be_run_is_refused_in_words() -> None:
    with pytest.raises(ValueError, match="No scenario 'lagoon' comes with"):
        gymnasium.make("mucat/Scenario-v0", scenario="lagoon")
    with pytest.raises(ValueError, match="title is missing"):
        gymnasium.make("mucat/Scenario-v0", scenario="name = 'x'\n")
    with pytest.raises(ValueError, match="The duration is 0 s"):
        gymnasium.make(HOVER, duration=0)
    env = gymnasium.make(HOVER, duration=3).unwrapped
    with pytest.raises(RuntimeError, match="call reset first"):
        env.step(REST)
    env.reset(seed=1)
    for action in (REST[:5], REST + 2, REST * np.nan):
        with pytest.raises(ValueError, match="6 numbers from -1 to 1"):
            env.step(action)
    env.close()


@pytest.mark.parametrize("agent", ["random", "PID"])
def test_the_agents_of_the_manual_swim(agent: str, capsys: pytest.CaptureFixture[str]) -> None:
    (text,) = [block.text for block in read_blocks("use/learn.md") if f"{agent}: {{" in block.text]
    fewer = text.replace("range(100)", "range(1)").replace("-v0", "-v0").replace('-v0"', '-v0", duration=12')
    exec(compile(fewer, "learn.md", "exec"), {})
    mean = float(capsys.readouterr().out.partition(": ")[2].partition(" of")[0])
    assert (mean > 60) if agent == "PID" else (mean < 60)


def test_nothing_else_loads_gymnasium() -> None:
    program = "import sys, mucat, server.cli; print('gymnasium' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
