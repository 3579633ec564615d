"""The lab as a process, as the server starts it."""

import ctypes
import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

from robot_runtime.experiments.comm_test.document import CommTest
from tests.board.rig import ROOT

LIMIT = 240.0
"""s of real time for its end, on a busy computer that has to compile the sketches first."""
COMMAND = [sys.executable, "-m", "robot_runtime.experiments.comm_test", "--build", str(ROOT / "build")]
Event = dict[str, Any]


def write_document(*tests: CommTest) -> bytes:
    return json.dumps([asdict(test) for test in tests]).encode()


@contextmanager
def lab(document: bytes, *options: str) -> Iterator[subprocess.Popen[bytes]]:
    """A running lab that has read the document; it is killed at the end if it still runs."""
    command = [*COMMAND, *options]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT
    ) as process:
        try:
            assert process.stdin
            process.stdin.write(document)
            process.stdin.close()
            process.stdin = None
            yield process
        finally:
            if process.poll() is None:
                process.kill()


def read_until(output: IO[bytes] | None, **expected: Any) -> list[Event]:
    """Return the events up to the first with these values."""
    assert output
    events: list[Event] = []
    for line in output:
        events.append(json.loads(line))
        if expected.items() <= events[-1].items():
            return events
    raise AssertionError(f"{expected} is not among {events}")


def run_lab(document: bytes, *options: str) -> tuple[int, list[Event]]:
    """Return the exit status and all events."""
    with lab(document, *options) as process:
        return _rest(process)


def cancel(process: subprocess.Popen[bytes]) -> tuple[int, list[Event]]:
    """Send SIGTERM; return the exit status and the events after it."""
    # The end of a parent with threads sends several.
    for _ in range(20):
        process.send_signal(signal.SIGTERM)
    return _rest(process)


def cancel_by_other_threads(process: subprocess.Popen[bytes]) -> tuple[int, list[Event]]:
    """Like `cancel`, with signals that the kernel gives to all threads but the main one, as it may."""
    others = {int(path.name) for path in Path(f"/proc/{process.pid}/task").iterdir()} - {process.pid}
    assert others
    for thread in others:
        signal_thread(process.pid, thread)
    return _rest(process)


def signal_thread(process: int, thread: int) -> None:
    """Send SIGTERM to one thread, tgkill(2)."""
    if ctypes.CDLL(None, use_errno=True).tgkill(process, thread, signal.SIGTERM) != 0:
        raise OSError(ctypes.get_errno(), "tgkill failed")


def _rest(process: subprocess.Popen[bytes]) -> tuple[int, list[Event]]:
    report, errors = process.communicate(timeout=LIMIT)
    # An upload in real time may have to be tried again where the computer is busy.
    assert [line for line in errors.splitlines() if not line.endswith(b"; trying again")] == []
    return process.returncode, [json.loads(line) for line in report.splitlines()]
