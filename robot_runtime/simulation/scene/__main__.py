"""`python -m robot_runtime.simulation.scene` renders the underwater scene of a simulated robot."""

import argparse
import logging
import signal
import sys
from pathlib import Path

from robot_runtime.clock import SteadyClock
from robot_runtime.durable_files import keep_private
from robot_runtime.simulation.scene.process import SceneProcess
from robot_runtime.transport.lifetime import (
    add_server_options,
    end_on_request,
    end_with_parent,
    limit_memory,
)
from robot_runtime.transport.network import LOCAL_ONLY, connect_settings
from robot_runtime.transport.zenoh_transport import ZenohTransport, join

BYTES_MAX = 1_500_000_000
"""Of the scene's own memory, its software renderer included."""


def main() -> None:
    """Run until SIGTERM or SIGINT."""
    keep_private()
    limit_memory(BYTES_MAX)
    arguments = _parser().parse_args()
    logging.basicConfig(level=logging.INFO, format="%(levelname)s scene: %(message)s")
    # It logs modules that are not needed.
    logging.getLogger("OpenGL").setLevel(logging.WARNING)
    if arguments.with_parent:
        end_with_parent()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: sys.exit())
    network = connect_settings(arguments.certificate) if arguments.certificate else LOCAL_ONLY
    joined = (
        join(arguments.robot, arguments.connect, network)
        if arguments.client
        else ZenohTransport(arguments.robot, arguments.listen, arguments.connect)
    )
    with joined as messages:
        process = SceneProcess(messages, SteadyClock())
        end_on_request(arguments, process.end)
        process.run()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m robot_runtime.simulation.scene", description=__doc__)
    parser.add_argument(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help="Zenoh endpoint of the robot; may repeat",
    )
    parser.add_argument(
        "--listen",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help="Zenoh endpoint for the simulator to connect to; may repeat",
    )
    parser.add_argument(
        "--certificate", type=Path, metavar="FOLDER", help="certificate for a robot on another computer"
    )
    parser.add_argument("--robot", default="turtle", help="the robot's name, part of every Zenoh key")
    parser.add_argument("--client", action="store_true", help="the robot is on another computer")
    add_server_options(parser)
    return parser


if __name__ == "__main__":
    main()
