"""The kinds of board that a scenario in simulated time may run on."""

import os
from functools import partial
from pathlib import Path

from robot_runtime import places
from robot_runtime.config import LinkConfig
from robot_runtime.experiments.scenario.rig import MakeBoard
from robot_runtime.simulation.boards.emulated_board import EmulatedBoard
from robot_runtime.simulation.boards.firmware import firmware_path
from robot_runtime.simulation.boards.host_board import HostBoard

BUILD = Path(os.environ.get("MUCAT_BUILD", places.BUILD))
"""The folder of everything built."""


def boards() -> dict[str, MakeBoard]:
    """Return the factory of each kind of board: `host`, this computer, and `emulated`, the robot's chip."""
    elf = firmware_path(BUILD, LinkConfig().baud, ".elf")
    return {
        "host": partial(HostBoard, BUILD / "libhost_board.so"),
        "emulated": partial(EmulatedBoard, BUILD / "board", elf),
    }
