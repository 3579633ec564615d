"""The lab as a process: runs the tests of a document from its standard input, and reports progress.

On the robot's own board the last sketch stays; `--restore` uploads the robot's firmware again, and
`--read-out` reads what is on the board.

On its standard output are JSON objects, one to a line, with the word `event`:

- `started`: `test` (its place in the document), `firmware`, `tools`, `host`
- `phase`: `test`, `number` (of the cell), `phase`, which is `compile`, `upload` or `run`
- `cell`: `test`, `number`, `values`, the columns of an export
- `ended`: `test`, `state`, which is `complete`, `failed` or `cancelled`, `problem`
- `refused`: `problems`, field by field; the exit status is 2
"""

import argparse
import signal
import sys
from io import FileIO
from pathlib import Path

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.text_input import TextError, decode_text
from robot_runtime.experiments.comm_test.document import DOCUMENT_BYTES_MAX, read_document
from robot_runtime.experiments.comm_test.lab import (
    TEST_ERRORS,
    CommTestLab,
    EmulatedLab,
    EventWriter,
    RobotLab,
    read_from,
    run_tests,
    upload_to,
)
from robot_runtime.experiments.comm_test.line import Cancellation
from robot_runtime.experiments.comm_test.reset_pin import ResetError, find_reset
from robot_runtime.transport.lifetime import end_with_parent, give_way, limit_memory
from robot_runtime.transport.unbuffered_output import UnbufferedOutput

REFUSED = 2
"""The exit status for a document that cannot be run."""
NICENESS = 10
BYTES_MAX = 400_000_000
"""Of the process's own memory."""


def main() -> int:
    """Run the document. Exit status: 0 if every test is complete, 1 if one is not, 2 if it is refused."""
    parser = _parser()
    arguments = parser.parse_args()
    alone = arguments.restore or arguments.read_out
    if not alone and not (arguments.where and arguments.build):
        parser.error("--where and --build, or --restore or --read-out, are needed")
    if (alone or arguments.where == "robot") and not (arguments.port and arguments.reset):
        parser.error("the robot's board needs --port and --reset")
    if arguments.with_parent:
        end_with_parent()
    limit_memory(BYTES_MAX)
    if alone:
        return _transfer(arguments)
    stop = Cancellation()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stop.set())
    writer = EventWriter(UnbufferedOutput(FileIO(sys.stdout.fileno(), "wb", closefd=False)))
    try:
        tests = read_document(_decode(sys.stdin.buffer.read(DOCUMENT_BYTES_MAX + 1)))
    except ConfigError as problem:
        writer.tell("refused", problems=problem.texts)
        return REFUSED
    lab: CommTestLab = EmulatedLab(arguments.build, stop)
    if arguments.where == "emulated":
        give_way(NICENESS)
    else:
        try:
            pull = find_reset(arguments.reset)
        except ResetError as problem:
            sys.exit(f"comm_test: {problem}")
        lab = RobotLab(arguments.build, arguments.port, pull, arguments.reset == "dtr", stop)
    return 0 if run_tests(tests, lab, writer, stop) else 1


def _transfer(arguments: argparse.Namespace) -> int:
    stop, progress = Cancellation(), arguments.progress
    try:
        pull = find_reset(arguments.reset)
        if arguments.restore:
            upload_to(arguments.port, pull, arguments.restore, stop, progress)
        else:
            read_from(arguments.port, pull, arguments.read_out, stop, progress)
    except TEST_ERRORS as problem:
        sys.exit(f"comm_test: {problem}")
    return 0


def _decode(document: bytes) -> str:
    try:
        return decode_text(document)
    except TextError as problem:
        raise ConfigError(f"the document {problem}") from problem


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m robot_runtime.experiments.comm_test",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--build", type=Path, help="the folder of everything that is built")
    parser.add_argument("--where", choices=["emulated", "robot"], help="where the cells run")
    parser.add_argument("--restore", type=Path, metavar="HEX", help="only upload the robot's firmware")
    parser.add_argument("--read-out", type=Path, metavar="HEX", help="only read the board's firmware")
    parser.add_argument("--progress", type=Path, metavar="FILE", help="avrdude's output with its progress")
    parser.add_argument("--port", help="the robot's serial port")
    parser.add_argument("--reset", metavar="SPEC", help="gpio:CHIP:LINE, board:SOCKET or dtr")
    parser.add_argument("--with-parent", action="store_true", help="end, in order, when the parent ends")
    return parser


if __name__ == "__main__":
    sys.exit(main())
