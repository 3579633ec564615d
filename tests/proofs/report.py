"""`python -m tests.proofs.report [PROOF ...]`: every long proof, one after the other, with one report.

The report, build/proofs/report.md, is written anew after each proof, also where one fails. Interrupted, it
goes on where it stopped: what has a result on the same commit is not run again, unless it is named.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from bench.results import commit, machine

FOLDER = Path("build/proofs")
LINES = 30
"""Last lines of a proof's output that stand in the report."""


@dataclass(frozen=True, slots=True)
class Proof:
    """A target of the Makefile, and the statement that it proves."""

    target: str
    statement: str
    options: tuple[str, ...] = ()


PROOFS = (
    Proof("hostile", "No word from outside reaches a build, a file name or a path."),
    Proof("interface", "No request that the interface allows makes the server fail."),
    Proof("hours", "A recording of hours is whole, and an hour's load leaves no memory behind."),
    Proof("power", "A power cut loses no row that was acknowledged."),
    Proof("kills", "A killed server leaves no hole in a recording."),
    Proof("fuzz", "No bytes bring down the firmware's end of the line."),
    Proof("soak", "No corrupted frame is believed, and no reset loses a message."),
    Proof("faults", "Each fault stops the fins in time, and what was killed is back in time."),
    Proof("chaos", "An hour of faults of all kinds loses nothing that is not counted."),
    Proof("guards", "Each guard is missed by a test when it is taken away."),
    Proof("control", "The depth controllers, on each craft."),
    Proof("bench", "The figures and their goals.", ("LONG=1",)),
)


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of a proof on a commit."""

    target: str
    commit: str
    machine: str
    began: str
    seconds: float
    status: int
    said: str


def main() -> int:
    """Exit status: 1 where a proof failed."""
    unknown = sorted(set(sys.argv[1:]) - {proof.target for proof in PROOFS})
    if unknown:
        sys.exit(f"no proof {', '.join(unknown)}; there are {', '.join(proof.target for proof in PROOFS)}")
    named, now = sys.argv[1:], commit()
    file = FOLDER / "outcomes.json"
    outcomes = _read(file)
    FOLDER.mkdir(parents=True, exist_ok=True)
    for proof in PROOFS:
        known = outcomes.get(proof.target)
        if named and proof.target not in named:
            continue
        if not named and known is not None and known.commit == now:
            print(f"{proof.target}: has a result on {now} already", flush=True)
            continue
        outcomes[proof.target] = _run(proof, now)
        file.write_text(json.dumps({name: asdict(one) for name, one in outcomes.items()}, indent=2) + "\n")
        (FOLDER / "report.md").write_text(report(PROOFS, outcomes, now))
    print(f"\nThe report is in {FOLDER / 'report.md'}.")
    mine = [one for one in outcomes.values() if one.commit == now]
    return 1 if any(one.status for one in mine) else 0


def report(proofs: Sequence[Proof], outcomes: dict[str, Outcome], now: str) -> str:
    """Returns the report of a commit in Markdown; results of other commits count as missing."""
    mine = {name: one for name, one in outcomes.items() if one.commit == now}
    rows = [
        f"| [{proof.target}](#{proof.target}) | {proof.statement} | {_verdict(mine.get(proof.target))} "
        f"| {_minutes(mine.get(proof.target))} |"
        for proof in proofs
    ]
    details = [
        f"\n## {name}\n\nBegun {one.began} on {one.machine}.\n\n```text\n{one.said}\n```"
        for name, one in mine.items()
    ]
    head = [
        "# Proofs",
        "",
        f"Commit {now}.",
        "",
        "| proof | statement | result | minutes |",
        "|---|---|---|---|",
    ]
    return "\n".join([*head, *rows, *details]) + "\n"


def _read(file: Path) -> dict[str, Outcome]:
    if not file.exists():
        return {}
    return {name: Outcome(**one) for name, one in json.loads(file.read_text()).items()}


def _run(proof: Proof, now: str) -> Outcome:
    """Run a proof; its output is printed at once, and stored in a log."""
    print(f"\n== {proof.target}: {proof.statement}", flush=True)
    began, started = datetime.now(UTC).isoformat(timespec="seconds"), time.monotonic()
    log = FOLDER / f"{proof.target}.log"
    lines: list[str] = []
    command = ["make", "--no-print-directory", proof.target, *proof.options]
    with (
        log.open("w") as output,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=_environment()
        ) as process,
    ):
        assert process.stdout is not None
        for line in process.stdout:
            output.write(line)
            sys.stdout.write(line)
            sys.stdout.flush()
            lines = [*lines, line.rstrip()][-LINES:]
    return Outcome(
        proof.target,
        now,
        machine(),
        began,
        time.monotonic() - started,
        process.returncode,
        "\n".join(lines).strip(),
    )


def _environment() -> dict[str, str]:
    """The environment without make's own variables for child processes."""
    return {
        name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")
    }


def _verdict(outcome: Outcome | None) -> str:
    if outcome is None:
        return "not run"
    return "held" if outcome.status == 0 else f"**failed** (status {outcome.status})"


def _minutes(outcome: Outcome | None) -> str:
    return "" if outcome is None else f"{outcome.seconds / 60:.0f}"


if __name__ == "__main__":
    sys.exit(main())
