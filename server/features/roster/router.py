"""`python -m server.features.roster.router` is a lab's Zenoh router.

It prints {"listening": [...]} once it listens, and ends with the lab's server.
"""

import json
import logging
import signal
import sys
from argparse import ArgumentParser
from pathlib import Path

from robot_runtime.contract.limits import ConfigError
from robot_runtime.durable_files import keep_private
from robot_runtime.transport.lifetime import end_with_parent, limit_memory
from robot_runtime.transport.zenoh_transport import open_session
from server.platform.lab_network import router_settings

BYTES_MAX = 400_000_000
"""Of the router's own memory: ten times what six robots need."""

log = logging.getLogger(__name__)


def main() -> int:
    """Route until SIGTERM. Return 1 if it cannot listen."""
    keep_private()
    limit_memory(BYTES_MAX)
    arguments = _parser().parse_args()
    end_with_parent()
    logging.basicConfig(level=logging.INFO, format="%(levelname)s router: %(message)s")
    # Blocked before Zenoh has threads, so that `sigwait` gets them.
    signals = (signal.SIGTERM, signal.SIGINT)
    signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        session = open_session("router", arguments.listen, network=router_settings(arguments.certificates))
    except (OSError, ConfigError) as problem:
        log.error("%s", problem)
        return 1
    sys.stdout.write(json.dumps({"listening": arguments.listen}) + "\n")
    sys.stdout.flush()
    signal.sigwait(signals)
    session.close()  # type: ignore[no-untyped-call]
    return 0


def _parser() -> ArgumentParser:
    parser = ArgumentParser(prog="python -m server.features.roster.router", description=__doc__)
    parser.add_argument("--certificates", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--listen", action="append", required=True, metavar="ENDPOINT")
    return parser


if __name__ == "__main__":
    sys.exit(main())
