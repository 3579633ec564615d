"""The changelog: each release is short, and its groups have one order, what a user must do first."""

import re
from pathlib import Path

BYTES_MAX = 8000
"""Of a release."""
GROUPS = (
    "What you must do",
    "Operate",
    "Record and study",
    "Scenarios, sweeps, lab",
    "For programs",
    "Install and run",
    "Safety",
)


def find_changelog_problems(root: Path) -> list[str]:
    """Return one line for each release that is too long, or whose groups are unknown or in another order."""
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    problems = []
    for release in re.split(r"^(?=## )", text, flags=re.MULTILINE)[1:]:
        name = release.partition("\n")[0].removeprefix("## ")
        if (size := len(release.encode())) > BYTES_MAX:
            problems.append(f"CHANGELOG.md: {name} has {size} bytes, and may have {BYTES_MAX}")
        groups = re.findall(r"^###+ (.*)$", release, re.MULTILINE)
        if groups != [group for group in GROUPS if group in groups]:
            problems.append(
                f"CHANGELOG.md: {name} has the groups {', '.join(groups)}; in this order: {', '.join(GROUPS)}"
            )
    return problems
