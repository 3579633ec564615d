"""Compares sessions in a process beside the server.

    python -m server.features.comparison DATABASE

reads tasks from its standard input, each a line of JSON: {"task", "query"}. It answers each on its standard
output: a line of JSON, {"status", "bytes"}, and so many bytes, which are the result, or the reason where the
status is not 200.
"""

import json
import sys
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path

from pydantic import TypeAdapter

from robot_runtime.transport.lifetime import end_with_parent, give_way, limit_memory
from server.features.comparison.comparer import Comparer
from server.features.comparison.report import write_report
from server.features.comparison.schemas import ComparisonQuery, LinesQuery, ReportQuery
from server.features.comparison.signals import Signal
from server.platform.errors import ApiError, UnavailableError
from server.platform.store import Reader

NICENESS = 10
"""Control, recording and the page go first."""
BYTES_MAX = 1_000_000_000
TOO_LARGE = "This takes more memory than it may. Choose fewer sessions, or fewer signals."

Task = Callable[[Comparer, str], bytes]


def compare(comparer: Comparer, query: str) -> bytes:
    """A comparison, as JSON."""
    return comparer.compare(ComparisonQuery.model_validate_json(query)).model_dump_json().encode()


def lines(comparer: Comparer, query: str) -> bytes:
    """The lines of a part, as JSON."""
    return comparer.lines(LinesQuery.model_validate_json(query)).model_dump_json().encode()


def signals(comparer: Comparer, query: str) -> bytes:
    """The signals of the session of this number, as JSON."""
    return TypeAdapter(list[Signal]).dump_json(comparer.signals(json.loads(query)))


def report(comparer: Comparer, query: str) -> bytes:
    """A report, as HTML."""
    asked = ReportQuery.model_validate_json(query)
    return write_report(comparer.compare(asked.parse()), asked.shown).encode()


TASKS: Mapping[str, Task] = {"compare": compare, "lines": lines, "signals": signals, "report": report}


def main() -> int:
    """Answer until the standard input ends."""
    end_with_parent()
    give_way(NICENESS)
    limit_memory(BYTES_MAX)
    reader = Reader(Path(sys.argv[1]))
    comparer = Comparer(reader)
    for line in sys.stdin.buffer:
        asked = json.loads(line)
        try:
            _answer(200, TASKS[asked["task"]](comparer, asked["query"]))
        except ApiError as problem:
            _answer(problem.status, problem.detail.encode())
        except MemoryError:
            # What the caches hold would be in the way of all that follows.
            comparer = Comparer(reader)
            _answer(422, TOO_LARGE.encode())
        except Exception as problem:
            # Whatever it is, the server says it, and the next task is answered.
            traceback.print_exc()
            why = f"The sessions cannot be compared: {type(problem).__name__}: {problem}"
            _answer(UnavailableError.status, why.encode(errors="replace"))
    return 0


def _answer(status: int, body: bytes) -> None:
    head = json.dumps({"status": status, "bytes": len(body)}).encode()
    sys.stdout.buffer.write(head + b"\n" + body)
    sys.stdout.buffer.flush()


if __name__ == "__main__":
    sys.exit(main())
