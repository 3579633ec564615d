"""A finding of the doctor: the outcome of one check."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

Verdict = Literal["ok", "look", "wrong"]
"""Good; something that may become a problem; something that keeps the robot from working, or from safety."""


@dataclass(frozen=True, slots=True)
class Finding:
    """The outcome of one check: a sentence, and the command or act that solves the problem."""

    name: str
    title: str
    verdict: Verdict
    text: str
    mend: str = ""


class Reporter:
    """Maker of the findings of one check, which all have its name and title."""

    def __init__(self, name: str, title: str) -> None:
        self._name = name
        self._title = title

    def ok(self, text: str) -> Finding:
        """Return a good finding."""
        return Finding(self._name, self._title, "ok", text)

    def look(self, text: str, mend: str) -> Finding:
        """Return a finding that deserves attention."""
        return Finding(self._name, self._title, "look", text, mend)

    def wrong(self, text: str, mend: str) -> Finding:
        """Return a finding about a problem."""
        return Finding(self._name, self._title, "wrong", text, mend)


def worst(findings: Iterable[Finding]) -> Verdict:
    """Return the gravest verdict; "ok" without findings."""
    order: tuple[Verdict, ...] = ("ok", "look", "wrong")
    return max((finding.verdict for finding in findings), key=order.index, default="ok")


def print_findings(findings: Iterable[Finding], echo: Callable[[str], None]) -> None:
    """Print each finding, and below it the command that solves the problem."""
    for finding in findings:
        echo(f"{finding.verdict:6}{finding.title}: {finding.text}")
        if finding.mend:
            echo(f"      → {finding.mend}")
