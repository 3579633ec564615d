"""The report of the proof of a lab: what failed, and what came of it."""

import time
from dataclasses import dataclass, field
from pathlib import Path

from tests.proofs.lab.content import MissedTicks

FILE = Path("build/proofs/lab.md")
HEAD = (
    "| failure | lasted, s | whole again after, s | before, after | control ticks left out (longest pause) "
    "| words |\n|---|---|---|---|---|---|"
)


@dataclass
class FailureOutcome:
    """One failure. `began`, `mended` and `whole` in s, steady clock."""

    name: str
    began: float = 0.0
    mended: float = 0.0
    whole: float = 0.0
    before: str = ""
    """Of the session that was being pulled, or rows of the sweep, when it began."""
    after: str = ""
    """The same when all was whole again."""
    message: str = ""
    """The words of lab or sweep meanwhile."""
    missed: dict[str, MissedTicks] = field(default_factory=dict)
    """Of the robots that swam."""

    @property
    def row(self) -> str:
        """The failure as a row of a table."""
        missed = ", ".join(
            f"{name} {ticks.count} ({ticks.longest:.2f} s)" for name, ticks in self.missed.items()
        )
        lasted, again = f"{self.mended - self.began:.1f}", f"{self.whole - self.mended:.1f}"
        cells = (self.name, lasted, again, f"{self.before}, {self.after}", missed, self.message)
        return f"| {' | '.join(cells)} |"


@dataclass
class LabReport:
    """The failures, figures beside them, and problems."""

    failures: list[FailureOutcome] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    """Figures beside the failures, by their names."""
    problems: list[str] = field(default_factory=list)
    began: float = field(default_factory=time.monotonic)

    def tell(self, text: str) -> None:
        """Print what is done, with the time."""
        print(f"{time.monotonic() - self.began:6.1f} s  {text}", flush=True)

    def check(self, holds: bool, problem: str) -> None:
        """Note a problem where something does not hold."""
        if not holds:
            self.tell(f"PROBLEM: {problem}")
            self.problems.append(problem)

    def text(self) -> str:
        """Return the report in Markdown."""
        return "\n".join(
            [
                HEAD,
                *(failure.row for failure in self.failures),
                "",
                *(f"- {name}: {value}" for name, value in self.facts.items()),
                *(f"- PROBLEM: {problem}" for problem in self.problems),
                f"- failures: {len(self.failures)}; problems: {len(self.problems)}",
            ]
        )

    def write(self) -> None:
        """Write it to build/proofs, and print it."""
        FILE.parent.mkdir(parents=True, exist_ok=True)
        FILE.write_text(self.text() + "\n")
        print(self.text(), flush=True)
