"""`mucat simulator`: water and scene on another computer, for a robot with its hardware in the loop."""

import os
import subprocess
import sys
from pathlib import Path

import click

from robot_runtime.contract.craft import load_craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.transport.network import connect_settings
from server.platform.command_line import FILE, CommandError


@click.command()
@click.option(
    "--connect",
    required=True,
    metavar="ENDPOINT",
    help="Where that robot listens: zenoh.listen in its robot.toml, such as tls/192.168.0.7:7447.",
)
@click.option(
    "--certificate",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    required=True,
    help="The folder that mucat certificate issue has made on that robot.",
)
@click.option("--robot", default="turtle", help="The robot's name.")
@click.option("--seed", type=int, default=1, help="Seed of the sensors' noise.")
@click.option(
    "--craft",
    type=FILE,
    help="The craft file of that robot, such as its craft.toml.  [default: the default craft]",
)
def simulator(connect: str, certificate: Path, robot: str, seed: int, craft: Path | None) -> None:
    """Simulate the water for a robot on another computer."""
    try:
        connect_settings(certificate)
        if craft is not None:
            load_craft(craft)
    except ConfigError as problem:
        raise CommandError(str(problem)) from problem
    there = ["--connect", connect, "--certificate", str(certificate), "--robot", robot]
    scene = [sys.executable, "-m", "robot_runtime.simulation.scene", "--client", "--with-parent", *there]
    subprocess.Popen(scene)
    # This process becomes the simulator; the scene ends with it.
    water = [sys.executable, "-m", "robot_runtime.simulation", "--in-the-loop", *there]
    own = ["--craft", str(craft)] if craft is not None else []
    os.execv(sys.executable, [*water, "--seed", str(seed), *own])
