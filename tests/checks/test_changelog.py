from pathlib import Path

import pytest

from tests.checks.changelog import BYTES_MAX, find_changelog_problems

HEAD = "# Changelog\n\n## [2.0.0] - 2026-01-01\n\n"


@pytest.mark.parametrize(
    "body",
    [
        "",
        "### What you must do\n\n- Nothing.\n\n### Safety\n\n- It stops.\n",
        "### Operate\n\n- " + "x" * (BYTES_MAX - 60) + "\n",
    ],
)
def test_a_short_release_in_order_has_no_problem(tmp_path: Path, body: str) -> None:
    (tmp_path / "CHANGELOG.md").write_text(HEAD + body)
    assert find_changelog_problems(tmp_path) == []


@pytest.mark.parametrize(
    ("body", "problem"),
    [
        ("### Operate\n\n- A\n\n### What you must do\n\n- B\n", "2.0.0"),
        ("### Added\n\n- A\n", "has the groups Added"),
        ("### Operate\n\n- A\n\n### Operate\n\n- B\n", "Operate, Operate"),
        ("### Operate\n\n- " + "µ" * (BYTES_MAX // 2) + "\n", f"may have {BYTES_MAX}"),
    ],
)
def test_another_order_or_a_long_release_is_found(tmp_path: Path, body: str, problem: str) -> None:
    (tmp_path / "CHANGELOG.md").write_text(f"{HEAD}{body}\n## [1.0.0]\n\n### Safety\n\n- It stops.\n")
    (line,) = find_changelog_problems(tmp_path)
    assert line.startswith("CHANGELOG.md: [2.0.0]")
    assert problem in line
