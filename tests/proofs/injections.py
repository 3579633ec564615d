"""`python -m tests.proofs.injections 100 [robot | processes] [WORD ...]`: inject faults; 1 past a limit.

First the faults of robot and chip, in simulated time (with words, those that have one of them in their name),
then those of the processes, in real time, which must have the processor before all other work. The figures go
to build/faults.json.
"""

import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from tests.proofs import faults, outages

RESULT = Path("build/faults.json")
KINDS = ["robot", "processes"]
PROCESSES = 2
ROBOTS = 2
"""That are disturbed at once; most of the time of an outage passes with waiting."""


def figures(
    measured: dict[str, faults.Measured], outcomes: Sequence[outages.OutageOutcome]
) -> dict[str, float]:
    """Return the longest times in ms: until the alarm, until the fins rested, until the motors lost power.

    Of processes, instead of the first, it is the time until all was well again; and of those that were
    killed, s of the slowest.
    """
    results = {f"fault.{name}_ms_max": 1000 * max(outcome.reported) for name, outcome in measured.items()}
    results |= {
        f"fault.{name}_rest_ms_max": 1000 * max(outcome.rest)
        for name, outcome in measured.items()
        if outcome.rest
    }
    results |= {
        f"fault.{name}_off_ms_max": 1000 * max(outcome.off)
        for name, outcome in measured.items()
        if outcome.off
    }
    for outage in dict.fromkeys(outcome.outage for outcome in outcomes):
        mine = [outcome for outcome in outcomes if outcome.outage == outage]
        results[f"fault.{outage.name}_ms_max"] = 1000 * max(outcome.again for outcome in mine)
        if outage.off is not None:
            results[f"fault.{outage.name}_off_ms_max"] = 1000 * max(outcome.off for outcome in mine)
    killed = [outcome.again for outcome in outcomes if outcome.outage.blow == "kill"]
    restarts = {"fault.restart_s_max": max(killed)} if killed else {}
    return restarts | {name: round(value, 1) for name, value in results.items()}


def _tell(text: str) -> None:
    print(text, flush=True)


def main() -> int:
    """Exit status."""
    times = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    seed = int(time.time())
    print(f"{times} injections of each fault, seed {seed} ...", flush=True)
    measured: dict[str, faults.Measured] = {}
    outcomes: list[outages.OutageOutcome] = []
    kinds = [word for word in sys.argv[2:] if word in KINDS] or KINDS
    name_parts = [word for word in sys.argv[2:] if word not in KINDS]
    rows = [row for row in faults.ROWS if not name_parts or any(part in row.name for part in name_parts)]
    if not rows:
        names = ", ".join(row.name for row in faults.ROWS)
        print(f"There is no fault with {' or '.join(name_parts)} in its name; there are {names}.")
        return 2
    if "robot" in kinds:
        measured = faults.measure_all(times, seed, rows, workers=PROCESSES)
        print(faults.table(measured), flush=True)
    if "processes" in kinds:
        outcomes = outages.measure_all(times, seed, ROBOTS, _tell)
        print(outages.table(outcomes))
    stored = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    RESULT.parent.mkdir(exist_ok=True)
    RESULT.write_text(json.dumps(stored | figures(measured, outcomes), indent=2) + "\n")
    late = any(outcome.problems for outcome in measured.values())
    return 1 if late or any(outcome.problems or outcome.is_slow for outcome in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())
