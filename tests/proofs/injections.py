"""`python -m tests.proofs.injections 100 [robot | processes]`: injects faults; status 1 beyond a limit.

First the faults of robot and chip, in simulated time, then those of the processes, in real time, which must
have the processor before all other work. The figures go to build/faults.json.
"""

import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from tests.proofs import faults, outages

RESULT = Path("build/faults.json")
PROCESSES = 2
ROBOTS = 2
"""That are disturbed at once; most of the time of an outage passes with waiting."""


def figures(measured: dict[str, faults.Measured], outcomes: Sequence[outages.Outcome]) -> dict[str, float]:
    """The longest times in ms: until the alarm, until the fins rested, until the motors lost power.

    Of processes, instead of the first, it is the time until all was well again; and of those that were
    killed, s of the slowest.
    """
    found = {f"fault.{name}_ms_max": 1000 * max(one.told) for name, one in measured.items()}
    found |= {f"fault.{name}_rest_ms_max": 1000 * max(one.rest) for name, one in measured.items() if one.rest}
    found |= {f"fault.{name}_off_ms_max": 1000 * max(one.off) for name, one in measured.items() if one.off}
    for outage in dict.fromkeys(one.outage for one in outcomes):
        mine = [one for one in outcomes if one.outage == outage]
        found[f"fault.{outage.name}_ms_max"] = 1000 * max(one.again for one in mine)
        if outage.off is not None:
            found[f"fault.{outage.name}_off_ms_max"] = 1000 * max(one.off for one in mine)
    killed = [one.again for one in outcomes if one.outage.blow == "kill"]
    restarts = {"fault.restart_s_max": max(killed)} if killed else {}
    return restarts | {name: round(value, 1) for name, value in found.items()}


def _tell(text: str) -> None:
    print(text, flush=True)


def main() -> int:
    """Exit status."""
    times = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    seed = int(time.time())
    print(f"{times} injections of each fault, seed {seed} ...", flush=True)
    measured: dict[str, faults.Measured] = {}
    outcomes: list[outages.Outcome] = []
    kinds = sys.argv[2:] or ["robot", "processes"]
    if "robot" in kinds:
        measured = faults.measure_all(times, seed, workers=PROCESSES)
        print(faults.table(measured), flush=True)
    if "processes" in kinds:
        outcomes = outages.measure_all(times, seed, ROBOTS, _tell)
        print(outages.table(outcomes))
    stored = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    RESULT.parent.mkdir(exist_ok=True)
    RESULT.write_text(json.dumps(stored | figures(measured, outcomes), indent=2) + "\n")
    late = any(one.problems for one in measured.values())
    return 1 if late or any(one.problems or one.is_slow for one in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())
