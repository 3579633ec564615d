"""`mucat simulator`: the water, and what there is to see in it, on a computer of their own.

For a robot with its hardware in the loop.
"""

import argparse
import os
import subprocess
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    Actions = argparse._SubParsersAction[argparse.ArgumentParser]


def add_arguments(commands: "Actions") -> None:
    """Add the command to those of `mucat`."""
    parser = commands.add_parser("simulator", help="simulate the water for a robot on another computer")
    parser.add_argument(
        "--connect",
        required=True,
        metavar="ENDPOINT",
        help="where that robot listens, as zenoh.listen in its robot.toml has it: tcp/192.168.0.7:7447",
    )
    parser.add_argument("--robot", default="turtle", help="its name; default turtle")
    parser.add_argument("--seed", type=int, default=1, help="of the sensors' noise; default 1")


def perform(options: argparse.Namespace) -> None:
    """Become the simulator's process; the scene's ends with it."""
    there = ["--connect", options.connect, "--robot", options.robot]
    scene = [sys.executable, "-m", "robot_runtime.simulation.scene", "--client", "--with-parent", *there]
    subprocess.Popen(scene)
    simulator = [sys.executable, "-m", "robot_runtime.simulation", "--in-the-loop", *there]
    os.execv(sys.executable, [*simulator, "--seed", str(options.seed)])
