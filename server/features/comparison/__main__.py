"""Makes one report in a process beside the server.

    python -m server.features.comparison DATABASE

reads a ReportQuery as JSON from its standard input, and writes the report, or {"status", "problem"} as JSON.
"""

import json
import os
import sys
from pathlib import Path

from robot_runtime.transport.lifetime import end_with_parent, limit_process
from server.features.comparison.comparer import Comparer
from server.features.comparison.report import write_report
from server.features.comparison.schemas import ReportQuery
from server.platform.errors import ApiError
from server.platform.store import Reader

NICENESS = 10
"""Control, recording and the page go first."""
BYTES_MAX = 1_000_000_000
SECONDS_MAX = 600
"""Memory, and time on a processor, of one report."""


def main() -> int:
    """Make the report. Exit status: 1 after a problem, which was reported."""
    end_with_parent()
    os.nice(NICENESS)
    limit_process(BYTES_MAX, SECONDS_MAX)
    query = ReportQuery.model_validate_json(sys.stdin.buffer.read())
    try:
        comparison = Comparer(Reader(Path(sys.argv[1]))).compare(query.parse())
        sys.stdout.buffer.write(write_report(comparison, query.shown).encode())
    except ApiError as problem:
        return _report(problem.status, problem.detail)
    except MemoryError:
        return _report(
            422, "The report takes more memory than it may. Choose fewer sessions, or fewer signals."
        )
    return 0


def _report(status: int, problem: str) -> int:
    sys.stdout.write(json.dumps({"status": status, "problem": problem}))
    return 1


if __name__ == "__main__":
    sys.exit(main())
