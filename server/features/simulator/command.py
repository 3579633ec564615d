"""`mucat simulator`: water and scene on another computer, for a robot with its hardware in the loop."""

import os
import subprocess
import sys

import click


@click.command()
@click.option(
    "--connect",
    required=True,
    metavar="ENDPOINT",
    help="Where that robot listens: zenoh.listen in its robot.toml, such as tcp/192.168.0.7:7447.",
)
@click.option("--robot", default="turtle", help="The robot's name.")
@click.option("--seed", type=int, default=1, help="Seed of the sensors' noise.")
def simulator(connect: str, robot: str, seed: int) -> None:
    """Simulate the water for a robot on another computer."""
    there = ["--connect", connect, "--robot", robot]
    scene = [sys.executable, "-m", "robot_runtime.simulation.scene", "--client", "--with-parent", *there]
    subprocess.Popen(scene)
    # This process becomes the simulator; the scene ends with it.
    water = [sys.executable, "-m", "robot_runtime.simulation", "--in-the-loop", *there]
    os.execv(sys.executable, [*water, "--seed", str(seed)])
