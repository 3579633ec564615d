"""The bring-up's findings, as text."""

from dataclasses import dataclass
from typing import Literal

Verdict = Literal["good", "note", "wrong"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """One check of one part. `advice` says what to do where it is not good."""

    what: str
    expected: str
    measured: str
    verdict: Verdict = "good"
    advice: str = ""
