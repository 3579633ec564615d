"""`python -m tests.proofs.bring_ups [page] [shell]`: a bring-up of a robot with each mistake.

On the page in Chromium, and from a shell. Each begins anew, does the steps in their order as a person would,
and must end at the step that the mistake belongs to, with the words that name it. A fresh robot, one whose
peculiarities a calibration takes away, and one with parts at the limits of what is sound pass all steps.
"""

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from tests.board.bring_up import NAMED
from tests.browser.bringing_up import PagePerson, wait_for_the_robot
from tests.browser.opening import DESKTOP, launched, opened_page, signed_in
from tests.proofs.bring_up_shell import bring_up_from_shell
from tests.stack import Stack

SOUND: tuple[tuple[str, ...], ...] = (
    (),
    (
        "leads-reversed:front-right",
        "encoder-reversed:back-left",
        "imu-turned:-y+x+z",
        "gyro-offset:-3,12,20",
        "beacons-inverted",
        "regulator-off:5",
    ),
    ("encoder-noise:2", "backlash:0.05", "pack-resistance:0.2"),
)
"""Robots that pass: what they have becomes their calibration, or is harmless."""

Outcome = tuple[str | None, str, str]
"""The first step that is wrong, None where none is; all advice of it; and the report."""


def main(where: list[str]) -> int:
    """Run them; returns the number of those that did not end as they must."""
    failed = 0
    if not where or "page" in where:
        failed += _try_all("page", _on_pages())
    if not where or "shell" in where:
        failed += _try_all("shell", bring_up_from_shell)
    return failed


def _try_all(where: str, bring_up: Callable[[tuple[str, ...]], Outcome]) -> int:
    first: dict[str, tuple[str, str]] = {}
    for mistake, step, words in NAMED:
        first.setdefault(mistake, (step, words))
    failed = 0
    for mistake, (step, words) in first.items():
        failed += not _try(where, bring_up, (mistake,), step, words)
    for mistakes in SOUND:
        failed += not _try(where, bring_up, mistakes, None, "")
    print(
        f"{where}: {len(first)} robots with a mistake, {len(SOUND)} sound ones, {failed} failed", flush=True
    )
    return failed


def _try(
    where: str,
    bring_up: Callable[[tuple[str, ...]], Outcome],
    mistakes: tuple[str, ...],
    step: str | None,
    words: str,
) -> bool:
    began = time.monotonic()
    found, advice, report = bring_up(mistakes)
    told = "The calibration is whole." if step is None else "Something is wrong"
    good = found == step and words in advice and told in report
    name = " ".join(mistakes) or "a fresh robot"
    ended = "passes" if found is None else f"found at {found}: {advice}"
    print(
        f"{'good' if good else 'BAD '} {where} {name}: {ended} ({time.monotonic() - began:.0f} s)", flush=True
    )
    return good


def _on_pages() -> Callable[[tuple[str, ...]], Outcome]:
    def bring_up(mistakes: tuple[str, ...]) -> Outcome:
        options = [word for mistake in mistakes for word in ("--mistake", mistake)]
        with (
            tempfile.TemporaryDirectory() as folder,
            Stack(Path(folder) / "data", "--uncalibrated", *options) as stack,
            launched() as browser,
            opened_page(browser, stack, signed_in(browser, stack), DESKTOP) as page,
        ):
            person = PagePerson(page, stack)
            person.begin()
            found = person.everything()
            advice = person.advice() if found else ""
            person.end()
            report = stack.api.get("/bring-up/report").text
            wait_for_the_robot(stack)
            return found, advice, report

    return bring_up


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[1:]) else 0)
