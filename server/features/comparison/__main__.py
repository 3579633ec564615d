"""Compares sessions in a process beside the server.

    python -m server.features.comparison DATABASE

reads tasks from its standard input, each a line of JSON: {"task", "query"}. It answers each on its standard
output: a line of JSON, {"status", "bytes"}, and so many bytes, which are the result, or the reason where the
status is not 200.
"""

import sys

from robot_runtime.transport.lifetime import end_with_parent, give_way, limit_memory

NICENESS = 10
"""Control, recording and the page go first."""
BYTES_MAX = 1_000_000_000


def main() -> int:
    """Answer tasks until the standard input ends."""
    end_with_parent()
    give_way(NICENESS)
    limit_memory(BYTES_MAX)
    # Here, so that others go first while the libraries are loaded, too.
    from server.features.comparison.tasks import answer_all
    from server.platform.engine import read_location

    answer_all(read_location(sys.argv[1]), sys.stdin.buffer)
    return 0


if __name__ == "__main__":
    sys.exit(main())
