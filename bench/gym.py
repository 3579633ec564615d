"""The environment of Gymnasium: steps in each second of the processor's time, and of the wall's."""

import time

import gymnasium

import mucat.gym
from robot_runtime.experiments.scenario.episode import STEP


def measure() -> dict[str, float]:
    """Measure whole episodes of an agent that acts by chance, with the beginnings of new ones."""
    gymnasium.register_envs(mucat.gym)
    env = gymnasium.make("mucat/HoverInACurrent-v0")
    env.action_space.seed(1)
    env.reset(seed=0)
    steps, episode = 0, 0
    worked, began = time.process_time(), time.monotonic()
    while steps < 1000:
        episode += 1
        env.reset(seed=episode)
        over = False
        while not over:
            _, _, terminated, truncated, _ = env.step(env.action_space.sample())
            steps, over = steps + 1, terminated or truncated
    worked, wall = time.process_time() - worked, time.monotonic() - began
    env.close()
    return {
        "gym.steps_per_s": steps / worked,
        "gym.speed_x": steps * STEP / worked,
        "gym.speed_wall_x": steps * STEP / wall,
    }
