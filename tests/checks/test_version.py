from pathlib import Path

import pytest

from server import VERSION
from tests.checks.version import find_other_versions


def write(root: Path, library: str, changes: str) -> None:
    (root / "firmware").mkdir()
    (root / "firmware/library.properties").write_text(f"name=mucat\nversion={library}\n")
    (root / "CHANGELOG.md").write_text(f"# Changelog\n\n## [Unreleased]\n\n## [{changes}] - 2026-01-01\n")


@pytest.mark.parametrize(
    ("library", "changes", "named"),
    [("9.9.9", VERSION, "firmware/library.properties"), (VERSION, "9.9.9", "CHANGELOG.md")],
)
def test_another_version_is_found(tmp_path: Path, library: str, changes: str, named: str) -> None:
    write(tmp_path, library, changes)
    (problem,) = find_other_versions(tmp_path)
    assert problem.startswith(f"{named} says version 9.9.9")
