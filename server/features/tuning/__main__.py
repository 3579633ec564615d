"""Predicts step responses in a process beside the server.

    python -m server.features.tuning CRAFT BUILD

answers tasks, see server/processes/task_process.py: each is a query and the robot's section [control], each
result a prediction. CRAFT is the craft's file, BUILD the folder of everything built.
"""

import gc
import os
import sys
from pathlib import Path

from robot_runtime.transport.lifetime import end_with_parent, give_way, limit_memory

NICENESS = 10
"""Control, recording and the page go first."""
BYTES_MAX = 1_000_000_000


def main() -> int:
    """Answer tasks until the standard input ends."""
    end_with_parent()
    give_way(NICENESS)
    limit_memory(BYTES_MAX)
    craft, build = sys.argv[1:]
    # Read when the boards are imported.
    os.environ["MUCAT_BUILD"] = build
    # Here, so that others go first while the libraries are loaded, too.
    from server.features.tuning.prediction_tasks import answer_all

    # The libraries stay: without them the search for garbage takes a tenth of the time less.
    gc.freeze()
    answer_all(Path(craft), sys.stdin.buffer)
    return 0


if __name__ == "__main__":
    sys.exit(main())
