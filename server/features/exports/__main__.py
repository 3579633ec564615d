"""`python -m server.features.exports`: one file, or the examination of one archive, beside the server.

It reports progress as lines of JSON on its output: {"progress": 0..1}, and last {"bytes", "sha256"}, or
{"archive": ...}, or {"problem": words}.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from robot_runtime.transport.lifetime import end_with_parent
from server.features.exports.archive_reader import ArchiveError, examine
from server.features.exports.files import FileWriteError, write_part
from server.features.exports.formats import check
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.features.sessions.recording import RecordingError
from server.features.sessions.session import find_row
from server.platform.store import Reader, StoreError

NICENESS = 15
"""Control and recording go first."""
TELL_SECONDS = 0.2


def main() -> int:
    """Exit status: 1 after a problem, which was reported."""
    parser = argparse.ArgumentParser(prog="python -m server.features.exports", description=__doc__)
    actions = parser.add_subparsers(dest="action", required=True)
    write = actions.add_parser("write", help="write a session as a file")
    write.add_argument("database", type=Path)
    write.add_argument("session", type=int)
    write.add_argument(
        "options",
        type=ExportOptions.model_validate_json,
        help="ExportOptions, JSON",
    )
    write.add_argument("path", type=Path)
    look = actions.add_parser("examine", help="look whether an archive can be imported")
    look.add_argument("path", type=Path)
    options = parser.parse_args()
    end_with_parent()
    os.nice(NICENESS)
    try:
        if options.action == "write":
            _write(options.database, options.session, options.options, options.path)
        else:
            examine(options.path, _Progress().tell)
            _tell({"examined": True})
    except (ExportRequestError, ArchiveError, FileWriteError, RecordingError) as problem:
        _tell({"problem": str(problem)})
        return 1
    except StoreError as problem:
        _tell({"problem": f"The database does not work: {problem}."})
        return 1
    return 0


def _write(database: Path, session: int, options: ExportOptions, path: Path) -> None:
    store = Reader(database)
    row = find_row(store, session)
    if row is None:
        raise ExportRequestError(f"There is no session {session} any more.")
    source = ExportSelection(store, row, options, _Progress().tell)
    written = write_part(path, lambda output: check(options).write(store, source, output))
    _tell(written._asdict())


class _Progress:
    """Tells it a few times a second."""

    def __init__(self) -> None:
        self._reported = time.monotonic()

    def tell(self, share: float) -> None:
        now = time.monotonic()
        if now - self._reported >= TELL_SECONDS:
            self._reported = now
            _tell({"progress": share})


def _tell(message: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
