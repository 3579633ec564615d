"""`python -m robot_runtime.experiments.scenario --board host|emulated`: run a scenario in simulated time.

It goes as fast as it can. The scenario's TOML comes on standard input. Messages go out on standard output, or
into a file: `u32 size | u8 kind | bytes`, little-endian. Kind 0 is a JSON object with the word `event`:
`started`, with the hashes of `firmware` and `software`, `progress`, `marker`, `ended`, or `refused`, with all
`problems`. Kind 1 are blocks, one after the other. SIGTERM and SIGINT cancel it in order.
"""

import argparse
import json
import logging
import signal
import sys
from contextlib import ExitStack
from functools import partial
from hashlib import sha256
from io import FileIO
from pathlib import Path
from struct import Struct
from typing import Any

import cv2

from robot_runtime.config import craft_document_in
from robot_runtime.contract.craft import DEFAULT_DOCUMENT
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.text_input import TextError, decode_text
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.document import read_scenario
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.link.link_driver import PortError
from robot_runtime.provenance import HASH_CHARACTERS, hash_software
from robot_runtime.simulation.boards.emulator_process import BoardError
from robot_runtime.transport.lifetime import give_way, limit_memory
from robot_runtime.transport.unbuffered_output import UnbufferedOutput

HEADER = Struct("<IB")
EVENTS, BLOCKS = 0, 1
REFUSED, FAILED = 2, 1
NICENESS = 10
"""A robot in real time goes first."""
BYTES_MAX = 1_000_000_000
"""Of the process's own memory."""


class RunOutput:
    """The output of a run's data and events."""

    def __init__(self, output: UnbufferedOutput) -> None:
        self._output = output

    def blocks(self, data: bytes) -> None:
        """Write a message of blocks."""
        self._write(BLOCKS, data)

    def event(self, event: str, **more: Any) -> None:
        """Write an event."""
        self._write(
            EVENTS, json.dumps({"event": event, **more}, allow_nan=False, separators=(",", ":")).encode()
        )

    def _write(self, kind: int, data: bytes) -> None:
        self._output.write(HEADER.pack(len(data), kind) + data)


def main() -> int:
    """Run the scenario. Return the exit status: 2 where the scenario is refused, 1 where its board fails."""
    made = boards()
    parser = argparse.ArgumentParser(prog="python -m robot_runtime.experiments.scenario", description=__doc__)
    parser.add_argument("--board", choices=sorted(made), default="host", help="what runs the firmware")
    parser.add_argument(
        "--craft", type=Path, metavar="FILE", help="the craft that scenarios call the robot's"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="write there instead of standard output")
    options = parser.parse_args()
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    give_way(NICENESS)
    limit_memory(BYTES_MAX)
    cv2.setNumThreads(1)
    with ExitStack() as opened:
        stream = opened.enter_context(
            FileIO(options.out or sys.stdout.fileno(), "wb", closefd=bool(options.out))
        )
        messages = RunOutput(UnbufferedOutput(stream))
        try:
            file = craft_document_in(options.craft) if options.craft else DEFAULT_DOCUMENT
            scenario = read_scenario(decode_text(sys.stdin.buffer.read()), file.craft)
        except ConfigError as problem:
            messages.event("refused", problems=problem.texts)
            return REFUSED
        except TextError as problem:
            messages.event("refused", problems=[f"the scenario {problem}"])
            return REFUSED
        run = ScenarioRun(scenario, made[options.board], messages, file)
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: run.cancel())
        try:
            run.perform(partial(_describe, scenario.name, scenario.seed, options.board))
        except (BoardError, PortError) as problem:
            logging.error("%s", problem)
            return FAILED
    return 0


def _describe(name: str, seed: int, board: str, firmware: bytes) -> dict[str, Any]:
    program = sha256(firmware).hexdigest()[:HASH_CHARACTERS]
    return {
        "scenario": name,
        "seed": seed,
        "board": board,
        "firmware": program,
        "software": hash_software(),
    }


if __name__ == "__main__":
    sys.exit(main())
