"""`python -m robot_runtime.simulation` simulates the water.

For an emulated board (`--board SOCKET`), or for a robot with hardware in the loop, on any computer
(`--in-the-loop --connect ENDPOINT`).
"""

import argparse
import logging
import signal
import sys
from pathlib import Path

from robot_runtime.clock import SteadyClock
from robot_runtime.config import craft_document_in
from robot_runtime.contract.craft import DEFAULT_DOCUMENT
from robot_runtime.contract.limits import ConfigError
from robot_runtime.durable_files import keep_private
from robot_runtime.simulation.water.hil import HilSimulator
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.simulation.water_process import WaterProcess
from robot_runtime.transport.lifetime import (
    add_server_options,
    end_on_request,
    end_with_parent,
    limit_memory,
)
from robot_runtime.transport.network import LOCAL_ONLY, connect_settings
from robot_runtime.transport.zenoh_transport import ZenohTransport, join

log = logging.getLogger(__name__)

BYTES_MAX = 400_000_000
"""Of the simulator's own memory."""


def main() -> int:
    """Run until SIGTERM or SIGINT. Return 2 if the craft cannot be used."""
    keep_private()
    limit_memory(BYTES_MAX)
    arguments = _parser().parse_args()
    logging.basicConfig(level=logging.INFO, format="%(levelname)s simulation: %(message)s")
    if arguments.with_parent:
        end_with_parent()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: sys.exit())
    try:
        file = craft_document_in(arguments.craft) if arguments.craft else DEFAULT_DOCUMENT
    except ConfigError as problem:
        log.error("%s", problem)
        return 2
    network = connect_settings(arguments.certificate) if arguments.certificate else LOCAL_ONLY
    joined = (
        join(arguments.robot, arguments.connect, network)
        if arguments.in_the_loop
        else ZenohTransport(arguments.robot, connect=arguments.connect)
    )
    with joined as messages:
        simulator = Simulator(SimulationParameters.of(file.craft), arguments.seed)
        process: WaterProcess | HilSimulator
        if arguments.in_the_loop:
            process = HilSimulator(simulator, messages, file)
        else:
            process = WaterProcess(simulator, arguments.board, messages, SteadyClock(), file)
        end_on_request(arguments, process.end)
        process.run()
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m robot_runtime.simulation", description=__doc__)
    target = parser.add_mutually_exclusive_group(required=True)
    target.add_argument("--board", type=Path, help="the emulated board's Unix socket")
    target.add_argument(
        "--in-the-loop", action="store_true", help="simulate the sensors of a board in the loop"
    )
    parser.add_argument(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help="Zenoh endpoint of the robot; may repeat",
    )
    parser.add_argument(
        "--certificate", type=Path, metavar="FOLDER", help="certificate for a robot on another computer"
    )
    parser.add_argument("--robot", default="turtle", help="the robot's name, part of every Zenoh key")
    parser.add_argument("--seed", type=int, default=1, help="seed of the sensors' noise")
    parser.add_argument("--craft", type=Path, metavar="FILE", help="the craft; an absent file: the default")
    add_server_options(parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())
