"""`python -m tests.server.features.lab.killed_lab ...` is `mucat`, whose server is killed again and again.

At each of these points it gets SIGKILL, once: while it downloads a session, when all of an import but its end
is stored, between a session and the note that it was pulled, and while it stores figures.
"""

import os
import signal
import sys
from collections.abc import Callable
from functools import wraps
from http.client import HTTPResponse
from pathlib import Path
from typing import Any

from server.cli import main
from server.features.comparison import figure_worker
from server.features.exports.imports import Imports
from server.features.lab import pull, robot_client
from server.features.lab.edits import note_pulled
from server.http.pinned_requests import read_piece
from server.library import retention

POINTS = ("download", "import", "note", "figures")
PERIOD = 0.3
"""s between two looks at the robots, and for what was left of an import."""


def die_before(point: str, folder: Path, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function, which kills its process once."""

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        mark = folder / f"killed-{point}"
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return function(*arguments, **named)

    return call


def place_kills(folder: Path) -> None:
    """Have the server die at each point."""
    pull.PERIOD = retention.PERIOD = figure_worker.PERIOD_SECONDS = PERIOD
    robot_client.PIECE_BYTES = 1000
    received: list[int] = []
    read, die = read_piece, die_before("download", folder, lambda: None)

    def read_some(address: str, answer: HTTPResponse, size: int) -> bytes:
        received.append(1)
        if len(received) > 2:
            die()
        return read(address, answer, size)

    robot_client.read_piece = read_some  # type: ignore[attr-defined]
    Imports._change = die_before("import", folder, Imports._change)  # type: ignore[method-assign]
    pull.note_pulled = die_before("note", folder, note_pulled)  # type: ignore[attr-defined]
    figure_worker._store = die_before("figures", folder, figure_worker._store)


if __name__ == "__main__":
    place_kills(Path(os.environ["MUCAT_DATA"]))
    sys.exit(main(sys.argv[1:]))
