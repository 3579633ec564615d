"""The profile: a computer with little processor time looks at smaller pictures, less often.

It hears the board once a control tick, and not some thirty times a second.

It also has little memory: there the runner of the server does not hold the server's libraries
(`server.startup`).

Control and the checks for faults are the same in both profiles, and so are the limits within which a fault is
found.
"""

import os
from dataclasses import replace
from typing import Literal

from robot_runtime.config import Config
from robot_runtime.contract.packets import Depth
from robot_runtime.link.timing import periods
from robot_runtime.transport.lifetime import memory_bytes

Profile = Literal["full", "lean"]

LEAN_BYTES = 1_000_000_000
"""Memory below which a computer with one processor is lean: a Raspberry Pi Zero W has 512 MB."""
LEAN_RATE = 2.0
"""Hz: pictures looked at, at most."""
LEAN_WIDTH, LEAN_HEIGHT = 160, 120
"""Pixels of a picture, at most."""
LEAN_STREAM_WIDTH, LEAN_STREAM_RATE = 320, 5.0
"""Pixels and Hz of the camera's stream, at most."""


def choose_profile(config: Config, processors: int, memory: int) -> Profile:
    """Return the profile for a computer with so many processors and bytes of memory."""
    if config.robot.profile != "auto":
        return config.robot.profile
    return "lean" if processors == 1 and memory < LEAN_BYTES else "full"


def fit(config: Config, profile: Profile) -> Config:
    """Return the configuration in this profile, which it then names."""
    config = replace(config, robot=replace(config.robot, profile=profile))
    if profile == "full":
        return config
    now = config.vision
    smaller = min(LEAN_WIDTH / now.width, LEAN_HEIGHT / now.height, 1.0)
    vision = replace(
        now,
        rate=min(now.rate, LEAN_RATE),
        width=round(now.width * smaller),
        height=round(now.height * smaller),
        stream_width=min(now.stream_width, LEAN_STREAM_WIDTH),
        stream_rate=min(now.stream_rate, LEAN_STREAM_RATE),
    )
    return replace(config, vision=vision)


def in_step(config: Config) -> bool:
    """Return True if the board is heard once a control tick.

    Not where that would be late: for a simulator in the loop, which moves by what the board sends, or on a
    line so slow that ticks have no depth of their own.
    """
    depth_period = periods(config.link.baud)[Depth]
    return (
        config.robot.profile == "lean"
        and config.robot.mode != "hil"
        and depth_period <= 1 / config.control.rate
    )


def profile_here(config: Config) -> Profile:
    """Return the profile on this computer."""
    return choose_profile(config, len(os.sched_getaffinity(0)), memory_bytes())


def fit_to_this_computer(config: Config) -> Config:
    """Return the configuration in the profile of this computer."""
    return fit(config, profile_here(config))
