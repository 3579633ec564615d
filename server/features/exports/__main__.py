"""Writes one export, or checks one archive, in a process beside the server.

    python -m server.features.exports write DATABASE IDENTIFIER OPTIONS PATH
    python -m server.features.exports examine PATH ROWS [MERGED]

IDENTIFIER is the session's. ROWS is the file to which `examine` writes the rows of the session,
MERGED the one for the archive with its chunks merged. OPTIONS are
ExportOptions as JSON. It prints lines of JSON: {"progress": 0..1}, and last {"bytes", "sha256"},
{"examined": true} or {"problem": text}.
"""

import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from robot_runtime.transport.lifetime import end_with_parent, give_way, limit_process

NICENESS = 15
"""Control and recording go first."""
REPORT_SECONDS = 0.2
BYTES_MAX = 2_000_000_000
SECONDS_MAX = 3600
"""Memory, and time on a processor, of one export or one check."""


def main() -> int:
    """Run the action. Return the exit status: 1 after a problem, which was reported."""
    end_with_parent()
    give_way(NICENESS)
    limit_process(BYTES_MAX, SECONDS_MAX)
    # Here and below, so that others go first while the libraries are loaded, too.
    from server.platform.errors import ApiError

    try:
        match sys.argv[1:]:
            case ["write", database, session, options, path]:
                _write(database, session, options, Path(path))
            case ["examine", path, rows, *merged]:
                _examine(Path(path), Path(rows), [Path(file) for file in merged])
            case _:
                sys.exit(__doc__)
    except ApiError as problem:
        _report({"problem": problem.detail})
        return 1
    except MemoryError:
        _report({"problem": f"It takes more than {BYTES_MAX / 1e9:g} GB of memory."})
        return 1
    return 0


def _write(database: str, identifier: str, asked: str, path: Path) -> None:
    from server.features.exports.files import write_part
    from server.features.exports.formats import check
    from server.features.exports.schemas import ExportOptions
    from server.features.exports.selection import ExportSelection, find_identified
    from server.platform.engine import read_location
    from server.platform.store import Reader

    store, options = Reader(read_location(database)), ExportOptions.model_validate_json(asked)
    source = ExportSelection(store, find_identified(store, identifier), options, _Progress().tell)
    kind = check(options)
    # A workbook's sheets are written there first: /tmp may lie in memory.
    tempfile.tempdir = str(path.parent)
    _report(write_part(path, lambda output: kind.write_unpurged(store, source, output))._asdict())


def _examine(path: Path, rows: Path, merged: list[Path]) -> None:
    from server.features.exports.archive_merging import write_merged
    from server.features.exports.archive_reader import examine

    examine(path, rows, _Progress().tell)
    for file in merged:
        write_merged(path, file)
    _report({"examined": True})


class _Progress:
    """The progress, reported a few times a second."""

    def __init__(self) -> None:
        self._reported = time.monotonic()

    def tell(self, share: float) -> None:
        now = time.monotonic()
        if now - self._reported >= REPORT_SECONDS:
            self._reported = now
            _report({"progress": share})


def _report(message: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
