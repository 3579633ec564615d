"""`python -m tests.proofs.report [PROOF ...]`: every long proof, with one report.

Proofs that mostly wait run beside others that only compute, which get what processor time is left. Those
whose robot needs the whole computer, and those that measure speed, run alone at the end. After each proof,
also one that fails, the report build/proofs/report.md and the manual's table of results are written anew.
Interrupted, it goes on where it stopped: what has a result on the same commit is not run again, unless it is
named.
"""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from bench.results import commit, machine
from tests.proofs import page
from tests.proofs.stages import STAGES, Proof, Stage

FOLDER = Path("build/proofs")
LINES = 30
"""Last lines of a proof's output that stand in the report."""
ENDING = (signal.SIGINT, signal.SIGTERM)
"""Ctrl-C, and what make passes on to its command when it is told to end."""


@dataclass(frozen=True, slots=True)
class ProofOutcome:
    """The result of a proof on a commit."""

    target: str
    commit: str
    machine: str
    began: str
    seconds: float
    status: int
    said: str


class Run:
    """Proofs on a commit; their outcomes and the report are stored after each."""

    def __init__(self, stages: Sequence[Stage], now: str) -> None:
        self._stages, self._now = stages, now
        self._file = FOLDER / "outcomes.json"
        self._outcomes = _read(self._file)
        self._proofs = [proof for stage in stages for lane in stage for proof in lane.proofs]
        self._storing, self._ending = threading.Lock(), threading.Event()
        self._running: dict[str, subprocess.Popen[str]] = {}

    @property
    def is_interrupted(self) -> bool:
        """True after Ctrl-C, or when it was told to end."""
        return self._ending.is_set()

    def perform(self, named: Sequence[str]) -> int:
        """Run those that are named, or those without a result. Return the number of failed ones."""
        request = {
            proof.target
            for proof in self._proofs
            if (proof.target in named if named else not self._is_known(proof.target))
        }
        for proof in self._proofs:
            if not named and proof.target not in request:
                print(f"{proof.target}: has a result on {self._now} already", flush=True)
        before = {number: signal.signal(number, lambda *_: self._end()) for number in ENDING}
        try:
            for stage in self._stages:
                self._perform_stage(stage, request)
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
        return sum(outcome.status != 0 for outcome in self._outcomes.values() if outcome.commit == self._now)

    def _is_known(self, target: str) -> bool:
        known = self._outcomes.get(target)
        return known is not None and known.commit == self._now

    def _perform_stage(self, stage: Stage, expected: set[str]) -> None:
        pools = [ThreadPoolExecutor(lane.at_once) for lane in stage]
        begun = [
            pool.submit(self._perform, proof, lane.prefix)
            for pool, lane in zip(pools, stage, strict=True)
            for proof in lane.proofs
            if proof.target in expected
        ]
        for process in begun:
            process.result()
        for pool in pools:
            pool.shutdown()

    def _end(self) -> None:
        """End what runs, of which nothing is stored."""
        self._ending.set()
        for process in list(self._running.values()):
            _interrupt(process)

    def _perform(self, proof: Proof, prefix: Sequence[str]) -> None:
        if self._ending.is_set():
            return
        print(f"\n== {proof.target}: {proof.statement}", flush=True)
        began, started = datetime.now(UTC).isoformat(timespec="seconds"), time.monotonic()
        status, answer = self._make(proof, prefix)
        if self._ending.is_set():
            return
        seconds = time.monotonic() - started
        outcome = ProofOutcome(proof.target, self._now, machine(), began, seconds, status, answer)
        with self._storing:
            self._outcomes[proof.target] = outcome
            stored = {name: asdict(outcome) for name, outcome in self._outcomes.items()}
            self._file.write_text(json.dumps(stored, indent=2) + "\n")
            (FOLDER / "report.md").write_text(report(self._proofs, self._outcomes, self._now))
            page.store(proof.target, status == 0, seconds)
            done = sum(map(self._is_known, (proof.target for proof in self._proofs)))
        minutes = f"{_minutes(outcome)} min; {done} of {len(self._proofs)} have a result"
        print(f"\n== {proof.target}: {_verdict(outcome)} after {minutes}", flush=True)

    def _make(self, proof: Proof, prefix: Sequence[str]) -> tuple[int, str]:
        """Exit status and last lines; all lines are printed at once, and stored in a log."""
        lines: list[str] = []
        command = [*prefix, "make", "--no-print-directory", proof.target, *proof.options]
        with (
            (FOLDER / f"{proof.target}.log").open("w") as output,
            subprocess.Popen(
                command,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                env=_environment(),
                process_group=0,
            ) as process,
        ):
            self._running[proof.target] = process
            if self._ending.is_set():
                _interrupt(process)
            assert process.stdout is not None
            for line in process.stdout:
                output.write(line)
                sys.stdout.write(f"{proof.target:<13}{line}")
                sys.stdout.flush()
                lines = [*lines, line.rstrip()][-LINES:]
        del self._running[proof.target]
        return process.returncode, "\n".join(lines).strip()


def main() -> int:
    """Exit status: 1 where a proof failed, or was interrupted."""
    named = sys.argv[1:]
    known = [proof.target for stage in STAGES for lane in stage for proof in lane.proofs]
    if unknown := sorted(set(named) - set(known)):
        sys.exit(f"no proof {', '.join(unknown)}; there are {', '.join(known)}")
    FOLDER.mkdir(parents=True, exist_ok=True)
    run = Run(STAGES, commit())
    failed = run.perform(named)
    if run.is_interrupted:
        print("\nInterrupted; the same command goes on.")
        return 1
    print(f"\nThe report is in {FOLDER / 'report.md'}.")
    return 1 if failed else 0


def report(proofs: Sequence[Proof], outcomes: dict[str, ProofOutcome], now: str) -> str:
    """Return the report of a commit in Markdown; results of other commits count as missing."""
    mine = {name: outcome for name, outcome in outcomes.items() if outcome.commit == now}
    rows = [
        f"| [{proof.target}](#{proof.target}) | {proof.statement} | {_verdict(mine.get(proof.target))} "
        f"| {_minutes(mine.get(proof.target))} |"
        for proof in proofs
    ]
    details = [
        f"\n## {name}\n\nBegun {outcome.began} on {outcome.machine}.\n\n```text\n{outcome.said}\n```"
        for name, outcome in mine.items()
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


def _read(file: Path) -> dict[str, ProofOutcome]:
    if not file.exists():
        return {}
    return {name: ProofOutcome(**values) for name, values in json.loads(file.read_text()).items()}


def _environment() -> dict[str, str]:
    """Return the environment without make's own variables and ONLY, which chooses parts of a proof."""
    dropped = {"MAKEFLAGS", "MAKELEVEL", "MAKEOVERRIDES", "MFLAGS", "ONLY"}
    return {name: value for name, value in os.environ.items() if name not in dropped}


def _interrupt(process: subprocess.Popen[str]) -> None:
    """As Ctrl-C does: make does not pass it on, and a proof that is killed leaves its robots behind."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGINT)


def _verdict(outcome: ProofOutcome | None) -> str:
    if outcome is None:
        return "not run"
    return "held" if outcome.status == 0 else f"**failed** (status {outcome.status})"


def _minutes(outcome: ProofOutcome | None) -> str:
    return "" if outcome is None else f"{outcome.seconds / 60:.0f}"


if __name__ == "__main__":
    sys.exit(main())
