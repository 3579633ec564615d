"""The lab as a process: runs the tests of a document from its standard input, and tells how it goes.

On its standard output are JSON objects, one to a line; docs/communication.md lists them.
"""

import argparse
import os
import signal
import sys
from pathlib import Path
from threading import Event

from robot_runtime.comm_test.document import DOCUMENT_BYTES_MAX, DocumentError, read_document
from robot_runtime.comm_test.lab import EmulatedLab, Teller, run_tests
from robot_runtime.lifetime import end_with_parent

REFUSED = 2
"""The exit status for a document that cannot be run."""
NICENESS = 10


def main() -> int:
    """Run the document. Exit status: 0 if every test is complete, 1 if one is not, 2 if it is refused."""
    arguments = _parser().parse_args()
    if arguments.with_parent:
        end_with_parent()
    stop = Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stop.set())
    teller = Teller(sys.stdout)
    try:
        tests = read_document(_decode(sys.stdin.buffer.read(DOCUMENT_BYTES_MAX + 1)))
    except DocumentError as problem:
        teller.tell("refused", problems=problem.problems)
        return REFUSED
    os.nice(NICENESS)
    return 0 if run_tests(tests, EmulatedLab(arguments.build, stop), teller, stop) else 1


def _decode(document: bytes) -> str:
    try:
        return document.decode()
    except UnicodeDecodeError as problem:
        raise DocumentError([f"the document is not UTF-8: {problem}"]) from problem


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m robot_runtime.comm_test",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--build", type=Path, required=True, help="the folder of everything that is built")
    parser.add_argument("--where", choices=["emulated"], required=True, help="where the cells run")
    parser.add_argument("--with-parent", action="store_true", help="end, in order, when the parent ends")
    return parser


if __name__ == "__main__":
    sys.exit(main())
