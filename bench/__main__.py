"""`python -m bench [PART ...]`: measures, prints a table beside the goals, and writes build/bench.json."""

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Collection, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

from bench.goals import GOALS
from bench.hour import SHARED
from bench.measurement import MeasurementError, measure
from bench.parts import PARTS, BenchPart
from bench.results import MeasuredFigure, Results


def main() -> int:
    """Run the parts.

    Return the exit status: 1 where a goal is missed, or a part or a goal's figure could not be measured.
    """
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument(
        "parts", nargs="*", metavar="PART", help=f"one of {', '.join(PARTS)}; without, all but the long ones"
    )
    parser.add_argument("--long", action="store_true", help="the long ones too")
    options = parser.parse_args()
    unknown = [name for name in options.parts if name not in PARTS]
    if unknown:
        parser.error(f"no part {', '.join(unknown)}; there are {', '.join(PARTS)}")
    parts = [
        part
        for part in PARTS.values()
        if part.name in options.parts or (not options.parts and (options.long or not part.is_long))
    ]
    results = Results()
    began = time.monotonic()
    # Emulated time does not depend on the computer's load; measurements of real time need it idle.
    with tempfile.TemporaryDirectory(prefix="mucat-") as hours:
        os.environ[SHARED] = hours
        # One more than cores, since some wait now and then.
        _measure_all([part for part in parts if part.is_emulated], (os.cpu_count() or 1) + 1, results)
        _measure_all([part for part in parts if not part.is_emulated], 1, results)
    print(f"\n{len(parts)} parts took {(time.monotonic() - began) / 60:.1f} min", file=sys.stderr)
    left_out = {part.name for part in PARTS.values() if part.is_long and not options.long}
    return summarise(results, {part.name for part in parts}, not options.parts, left_out)


def _measure_all(parts: Sequence[BenchPart], at_once: int, results: Results) -> None:
    with ThreadPoolExecutor(at_once) as pool:
        running = {pool.submit(measure, part): part for part in parts}
        for future in as_completed(running):
            part = running[future]
            try:
                measured = future.result()
            except MeasurementError as problem:
                results.fail(part.name, str(problem))
                print(f"{part.name} could not be measured: {problem}", file=sys.stderr, flush=True)
                continue
            results.add(part.name, measured.values, measured.slowness)
            for name in measured.values:
                print(_row(name, results.figures[name]), flush=True)
            print(f"{part.name} took {measured.took:.0f} s", file=sys.stderr, flush=True)


def summarise(results: Results, parts: set[str], is_whole: bool, left_out: Collection[str] = ()) -> int:
    """Print the goals that are met, missed and not measured; goals of omitted parts may have no figure."""
    mine = {name: figure for name, figure in results.figures.items() if is_whole or figure.part in parts}
    judged = {name: figure for name, figure in mine.items() if name in GOALS}
    missed = [name for name, figure in judged.items() if not _is_met(name, figure)]
    failed = sorted(part for part in results.failures if is_whole or part in parts)
    without = GOALS.keys() - mine.keys() if is_whole else set[str]()
    longer = {name for name in without if any(name.startswith(PARTS[part].prefix) for part in left_out)}
    absent = sorted(without - longer)
    print(f"\n{len(judged) - len(missed)} goals met, {len(missed)} missed, {len(absent)} without a figure")
    _list("Missed", (_row(name, mine[name]) for name in missed))
    _list("Failed parts", (f"  {part}: {results.failures[part].reason}" for part in failed))
    _list("Goals without a figure", (f"  {name}" for name in absent))
    _list("Goals of the long parts, which LONG=1 measures", (f"  {name}" for name in sorted(longer)))
    return 1 if missed or failed or absent else 0


def _list(title: str, lines: Iterable[str]) -> None:
    if entries := list(lines):
        print(f"\n{title}:", *entries, sep="\n")


def _is_met(name: str, figure: MeasuredFigure) -> bool:
    return GOALS[name].scaled(figure.slowness).is_met(figure.value)


def _row(name: str, figure: MeasuredFigure) -> str:
    row = f"  {name:<40} {figure.value:>12.4g}"
    if name not in GOALS:
        return row
    goal = GOALS[name]
    scaled = goal.scaled(figure.slowness)
    limit = f"{scaled}" if scaled == goal else f"{scaled} ({goal} on the reference machine)"
    return f"{row}   goal {limit:<8} {'met' if scaled.is_met(figure.value) else 'MISSED'}"


if __name__ == "__main__":
    sys.exit(main())
