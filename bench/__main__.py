"""`python -m bench [PART ...]`: measures, prints a table with the goals, and writes build/bench.json."""

import argparse
import importlib
import json
import sys
import time
from pathlib import Path

from bench.goals import GOALS

PARTS = (
    "firmware",
    "emulator",
    "physics",
    "scenario",
    "control",
    "camera",
    "vision",
    "codec",
    "link",
    "corruption",
    "chip",
    "fault",
    "comm_test",
    "store",
    "export",
    "setpoint",
    "connection",
    "start",
    "stack",
    "latency",
    "compare",
    "replay",
    "jitter",
    "hub",
    "page",
)
RESULT = Path("build/bench.json")


def main() -> int:
    """Exit status: 1 where a part could not be measured."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"one of {', '.join(PARTS)}; all without")
    wanted = parser.parse_args().parts
    unknown = [name for name in wanted if name not in PARTS]
    if unknown:
        parser.error(f"no part {', '.join(unknown)}; there are {', '.join(PARTS)}")
    figures: dict[str, float] = json.loads(RESULT.read_text()) if wanted and RESULT.exists() else {}
    failed = False
    for name in wanted or PARTS:
        began = time.monotonic()
        print(f"{name} ...", file=sys.stderr, flush=True)
        try:
            measured = importlib.import_module(f"bench.{name}").measure()
        except Exception as problem:
            failed = True
            print(f"{name} could not be measured: {problem}", file=sys.stderr)
            continue
        figures |= measured
        for figure, value in measured.items():
            print(_row(figure, value), flush=True)
        print(f"{name} took {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    missed = [_row(name, value) for name, value in figures.items() if name in GOALS and not _met(name, value)]
    if missed:
        print("\nGoals missed:", *missed, sep="\n")
    RESULT.parent.mkdir(exist_ok=True)
    RESULT.write_text(json.dumps(dict(sorted(figures.items())), indent=2) + "\n")
    return 1 if failed else 0


def _met(figure: str, value: float) -> bool:
    return GOALS[figure].met(value)


def _row(figure: str, value: float) -> str:
    row = f"  {figure:<40} {value:>12.4g}"
    if figure not in GOALS:
        return row
    return f"{row}   goal {GOALS[figure]!s:<8} {'met' if _met(figure, value) else 'MISSED'}"


if __name__ == "__main__":
    sys.exit(main())
