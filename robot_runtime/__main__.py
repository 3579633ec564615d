"""`python -m robot_runtime` runs the robot: serial link, vision and control, without the web server."""

import argparse
import logging
import sys
from dataclasses import replace
from math import inf
from pathlib import Path

from robot_runtime.config import Config, craft_in_force, load_with_text
from robot_runtime.contract.limits import ConfigError
from robot_runtime.control.controllers import check_control
from robot_runtime.control.craft_gains import tune_to_craft
from robot_runtime.durable_files import keep_private
from robot_runtime.profile import fit_to_this_computer
from robot_runtime.provenance import hash_software
from robot_runtime.robot import RobotRuntime
from robot_runtime.transport.lifetime import (
    add_server_options,
    end_on_request,
    end_with_parent,
    limit_memory,
)
from robot_runtime.transport.network import LOCAL_ONLY, listen_settings
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.settings_file import VisionSettingsFile

BYTES_MAX = 300_000_000
"""Of the runtime's own memory: most of what it needs is room for stacks that nobody touches, so that this
holds on the smallest computer as well."""


def main() -> int:
    """Run until SIGTERM or SIGINT. Return 2 if the configuration or an endpoint cannot be used."""
    keep_private()
    limit_memory(BYTES_MAX, share=inf)
    options = _options()
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    if options.with_parent:
        end_with_parent()
    try:
        config, text = load_with_text(options.config)
        config = fit_to_this_computer(config)
        check_control(config.control)
        craft = craft_in_force(config, options.config, options.data)
        config = replace(config, control=tune_to_craft(config.control, craft))
        with open_transport(config, options.data) as messages:
            port = options.port or config.link.port
            vision_file = VisionSettingsFile(options.data / "vision.json")
            robot = RobotRuntime(
                config, port, messages, craft, heartbeat=options.heartbeat, vision_file=vision_file
            )
            robot.serve()
            messages.serve("query/provenance", lambda _: {"configuration": text, "software": hash_software()})
            end_on_request(options, robot.close)
            robot.run()
    except (ConfigError, OSError) as problem:
        logging.error("%s", problem)
        return 2
    return 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m robot_runtime", description=__doc__)
    parser.add_argument("--config", type=Path, default=Path("robot.toml"), help="the robot's configuration")
    parser.add_argument("--data", type=Path, default=Path("data"), help="the data folder")
    parser.add_argument("--port", help="serial port; default: link.port of the configuration")
    parser.add_argument(
        "--heartbeat",
        type=float,
        metavar="SECONDS",
        help="stop the robot after this time without a server's heartbeat",
    )
    add_server_options(parser)
    return parser.parse_args()


def open_transport(config: Config, data: Path) -> ZenohTransport:
    """Open the runtime's transport. Raise OSError, and ConfigError where certificates are missing."""
    run, more = (data / "run").resolve(), config.zenoh.listen
    run.mkdir(parents=True, exist_ok=True)
    return ZenohTransport(
        config.robot.name,
        [f"unixsock-stream/{run}/runtime.sock", *more],
        [f"unixsock-stream/{run}/server.sock"],
        config.zenoh.scouting,
        network=listen_settings((data / "zenoh").resolve(), config.robot.name) if more else LOCAL_ONLY,
    )


if __name__ == "__main__":
    sys.exit(main())
