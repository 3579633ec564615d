"""`python -m bench.against COMMIT [PART ...]`: measures that commit and this tree alternately, in one run.

A computer is not as quick at all times. Each part is therefore measured in both trees, one right after the
other, in several rounds, and the tree that begins changes with each round. A figure differs where every round
of one tree lies beyond every round of the other.
"""

import argparse
import json
import subprocess
import sys
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from bench.goals import GOALS
from bench.parts import PARTS

_TREES = Path("build/against")
_MARGIN = 0.03
"""Share by which medians must differ too: less matters to nobody."""

Rounds = dict[str, list[float]]
"""A figure's value in each round."""


def main() -> int:
    """Compare. Return the exit status: 1 where a figure with a goal is worse, or a part failed here alone."""
    parser = argparse.ArgumentParser(prog="python -m bench.against", description=__doc__)
    parser.add_argument("commit", help="what this tree is compared with")
    parser.add_argument("parts", nargs="*", metavar="PART", help="all but the long ones without")
    parser.add_argument("--rounds", type=int, default=3, help="how often each is measured (3)")
    options = parser.parse_args()
    parts = options.parts or [part.name for part in PARTS.values() if not part.is_long]
    before, now = _check_out(options.commit), Path.cwd()
    print(f"  {'figure':<40} {'before':>10} {'now':>10} {'ratio':>7}")
    results = [_compare(part, before, now, options.rounds) for part in parts]
    return 0 if all(results) else 1


def _check_out(commit: str) -> Path:
    """Return a working tree of the commit, set up for measuring."""
    commit_hash = _run(["git", "rev-parse", "--short=10", f"{commit}^{{commit}}"], Path.cwd())
    tree = (_TREES / commit_hash).absolute()
    if not tree.exists():
        _run(["git", "worktree", "add", "--detach", str(tree), commit_hash], Path.cwd())
    print(f"Setting up {commit_hash} in {tree} ...", file=sys.stderr, flush=True)
    subprocess.run(
        ["make", "--silent", "setup-test", ".venv/.ready-bench", "host-firmware"], cwd=tree, check=True
    )
    return tree


def _run(command: list[str], folder: Path) -> str:
    ran = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, text=True, check=True)
    return ran.stdout.strip()


def _compare(part: str, before: Path, now: Path, rounds: int) -> bool:
    """Measure and print a part; return False where a figure with a goal is worse, or there is none."""
    measured: dict[Path, Rounds] = {before: defaultdict(list), now: defaultdict(list)}
    for number in range(rounds):
        for tree in (before, now) if number % 2 == 0 else (now, before):
            name = "before" if tree == before else "now"
            print(f"{part}, round {number + 1} of {rounds}, {name} ...", file=sys.stderr, flush=True)
            for figure, value in _measure(tree, part).items():
                measured[tree][figure].append(value)
    if not measured[now]:
        print(f"  {part} could not be measured in this tree")
        return False
    verdicts = {
        name: verdict(name, measured[before].get(name, []), values) for name, values in measured[now].items()
    }
    for name, values in measured[now].items():
        print(_row(name, measured[before].get(name, []), values, verdicts[name]), flush=True)
    return not any(verdict == "worse" for name, verdict in verdicts.items() if name in GOALS)


def _measure(tree: Path, part: str) -> dict[str, float]:
    """Return the part's figures by the tree's own program; no figures where it fails or lacks the part."""
    file = tree / "build/bench.json"
    file.unlink(missing_ok=True)
    command = [".venv/bin/python", "-m", "bench", part]
    subprocess.run(command, cwd=tree, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    if not file.exists():
        return {}
    stored = json.loads(file.read_text())
    # Before 0.3.0 the file was flat.
    figures = (
        {name: figure["value"] for name, figure in stored["figures"].items()}
        if "figures" in stored
        else stored
    )
    return {name: float(value) for name, value in figures.items()}


def verdict(name: str, before: Sequence[float], now: Sequence[float]) -> str:
    """Return the verdict of the rounds on a figure; without a goal, no direction counts as better."""
    if not before:
        return "new"
    if min(now) > max(before):
        grew = True
    elif max(now) < min(before):
        grew = False
    else:
        return "no difference"
    if abs(median(now) - median(before)) <= _MARGIN * abs(median(before)):
        return "no difference"
    if name not in GOALS:
        return "more" if grew else "less"
    return "better" if grew == GOALS[name].is_least else "worse"


def _row(name: str, before: Sequence[float], now: Sequence[float], verdict: str) -> str:
    if not before:
        return f"  {name:<40} {'':>10} {median(now):>10.4g} {'':>7} {verdict}"
    ratio = f"{median(now) / median(before):.3f}" if median(before) else "-"
    return f"  {name:<40} {median(before):>10.4g} {median(now):>10.4g} {ratio:>7} {verdict}"


if __name__ == "__main__":
    sys.exit(main())
