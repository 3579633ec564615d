from pathlib import Path

import pytest

from server import VERSION
from tests.checks.version import find_other_versions


def write(root: Path, library: str, changes: str, page: str) -> None:
    (root / "firmware").mkdir()
    (root / "firmware/library.properties").write_text(f"name=mucat\nversion={library}\n")
    (root / "CHANGELOG.md").write_text(f"# Changelog\n\n## [Unreleased]\n\n## [{changes}] - 2026-01-01\n")
    (root / "docs").mkdir()
    (root / "docs/install.md").write_text(f"Copy mucat-{page}-aarch64-python3.13, or mucat-lab-{page}.zip.\n")


@pytest.mark.parametrize(
    ("versions", "named"),
    [
        (("9.9.9", VERSION, VERSION), "firmware/library.properties"),
        ((VERSION, "9.9.9", VERSION), "CHANGELOG.md"),
        ((VERSION, VERSION, "9.9.9"), "docs/install.md"),
    ],
)
def test_another_version_is_found(tmp_path: Path, versions: tuple[str, str, str], named: str) -> None:
    write(tmp_path, *versions)
    (problem,) = find_other_versions(tmp_path)
    assert problem.startswith(f"{named} says version 9.9.9")
