"""`python -m robot_runtime.experiments.mission_trial --seeds 20`: try a mission in simulated time.

Standard input is a JSON object with `text`, `library` (texts by name) and `limits`. Standard output has one
JSON object a line: a result for each seed, or `problems` where the mission is refused.
"""

import argparse
import json
import logging
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import cv2

from robot_runtime.config import craft_document_in
from robot_runtime.contract.craft import DEFAULT_DOCUMENT
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.missions import MissionLimits
from robot_runtime.contract.parsing import parse
from robot_runtime.experiments.mission_trial.trial import trial_scenario, try_mission
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.link.link_driver import PortError
from robot_runtime.simulation.boards.emulator_process import BoardError
from robot_runtime.transport.lifetime import give_way, limit_memory

REFUSED, FAILED = 2, 1
NICENESS = 10
"""A robot in real time goes first."""
BYTES_MAX = 1_000_000_000
"""Of the process's own memory."""


def main() -> int:
    """Try the mission. Return the exit status: 2 where the mission is refused, 1 where its board fails."""
    made = boards()
    parser = argparse.ArgumentParser(prog="python -m robot_runtime.experiments.mission_trial")
    parser.add_argument("--board", choices=sorted(made), default="host", help="what runs the firmware")
    parser.add_argument("--craft", type=Path, metavar="FILE", help="the robot's craft")
    parser.add_argument("--seeds", type=int, default=1, help="how many, from --first on")
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    options = parser.parse_args()
    logging.basicConfig(level=logging.ERROR, format="%(levelname)s %(name)s: %(message)s")
    give_way(NICENESS)
    limit_memory(BYTES_MAX)
    cv2.setNumThreads(1)
    try:
        asked = json.load(sys.stdin)
        craft = craft_document_in(options.craft) if options.craft else DEFAULT_DOCUMENT
        limits = parse(MissionLimits, asked["limits"])
        for seed in range(options.first, options.first + options.seeds):
            scenario = trial_scenario(asked["text"], asked["library"], limits, seed, craft.craft)
            _write(asdict(try_mission(scenario, made[options.board], craft)))
    except ConfigError as problem:
        _write({"problems": problem.texts})
        return REFUSED
    except (BoardError, PortError) as problem:
        logging.error("%s", problem)
        return FAILED
    return 0


def _write(line: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(line, allow_nan=False, separators=(",", ":")) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
