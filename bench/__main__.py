"""`python -m bench [PART ...]`: measure, print a table, and write build/bench.json."""

import argparse
import importlib
import json
import sys
import time
from pathlib import Path

PARTS = ("firmware", "emulator", "physics", "codec", "link", "comm_test", "start", "stack", "latency")
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
            print(f"  {figure:<36} {value:>12.4g}")
        print(f"{name} took {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    RESULT.parent.mkdir(exist_ok=True)
    RESULT.write_text(json.dumps(dict(sorted(figures.items())), indent=2) + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
