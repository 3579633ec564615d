"""`python -m robot_runtime.simulation --board SOCKET`: the water around an emulated board."""

import argparse
import logging
import signal
from pathlib import Path

from robot_runtime.clock import SteadyClock
from robot_runtime.lifetime import add_server_options, end_with_parent, watch_server
from robot_runtime.messages import Messages
from robot_runtime.simulation.parameters import Parameters
from robot_runtime.simulation.process import Process
from robot_runtime.simulation.simulator import Simulator


def main() -> None:
    """Swim until SIGTERM or SIGINT."""
    arguments = _parser().parse_args()
    logging.basicConfig(level=logging.INFO, format="%(levelname)s simulation: %(message)s")
    if arguments.with_parent:
        end_with_parent()
    with Messages(arguments.robot, connect=arguments.connect) as messages:
        simulator = Simulator(Parameters(), arguments.seed)
        process = Process(simulator, arguments.board, messages, SteadyClock())
        if arguments.server_lock is not None:
            watch_server(arguments.server_lock, arguments.linger, SteadyClock(), process.end)
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: process.end())
        process.run()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m robot_runtime.simulation", description=__doc__)
    parser.add_argument("--board", type=Path, required=True, help="the emulated board's Unix socket")
    parser.add_argument(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help="Zenoh endpoint to publish to; may repeat",
    )
    parser.add_argument("--robot", default="turtle", help="the robot's name, part of every Zenoh key")
    parser.add_argument("--seed", type=int, default=1, help="of the sensors' noise")
    parser.add_argument("--with-parent", action="store_true", help="end when the parent process ends")
    add_server_options(parser)
    return parser


if __name__ == "__main__":
    main()
