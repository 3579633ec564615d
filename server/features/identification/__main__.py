"""Fits a craft in a process beside the server.

    python -m server.features.identification DATABASE CRAFT CHOICE

CRAFT is the file of the craft from which the fit starts, and may be absent; CHOICE is an
`IdentificationStart` as JSON. The standard output has lines of JSON: {"progress"}, at last {"result"} or
{"problem"}.
"""

import json
import sys
import traceback
from pathlib import Path

from robot_runtime.config import craft_in
from robot_runtime.contract.limits import ConfigError
from robot_runtime.errors import RefusedError
from robot_runtime.transport.lifetime import end_with_parent, give_way, limit_memory
from server.features.identification.run import run_identification
from server.features.identification.schemas import IdentificationStart
from server.platform.engine import read_location
from server.platform.errors import ApiError
from server.platform.store import Reader

NICENESS = 10
"""Control, recording and the page go first."""
BYTES_MAX = 2_000_000_000


def main() -> int:
    """Perform one fit."""
    end_with_parent()
    give_way(NICENESS)
    limit_memory(BYTES_MAX)
    database, craft, choice = sys.argv[1:]
    chosen = IdentificationStart.model_validate_json(choice)
    try:
        result = run_identification(
            Reader(read_location(database)),
            chosen.sessions,
            chosen.left_out,
            craft_in(Path(craft)),
            lambda share: _say({"progress": round(share, 3)}),
        )
    except (ApiError, RefusedError, ConfigError) as problem:
        _say({"problem": str(problem)})
    except MemoryError:
        _say({"problem": "This takes more memory than it may. Choose fewer sessions."})
    except Exception as problem:
        traceback.print_exc()
        _say({"problem": f"The sessions cannot be fitted: {type(problem).__name__}: {problem}"})
    else:
        _say({"result": result.model_dump()})
    return 0


def _say(message: dict[str, object]) -> None:
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
