"""The version: server.VERSION is the one place; whatever must repeat it says the same."""

import re
from pathlib import Path

from server import VERSION

REPEATED = {
    "firmware/library.properties": r"^version=(.*)$",
    "CHANGELOG.md": r"^## \[(\d.*?)\]",
}
"""Files, and where the version stands in them; the newest release comes first."""


def find_other_versions(root: Path) -> list[str]:
    """Return one line for each file whose version is not the program's."""
    return [
        f"{name} says version {match[1] if match else 'nothing'}, server/__init__.py {VERSION}"
        for name, pattern in REPEATED.items()
        if (match := re.search(pattern, (root / name).read_text(encoding="utf-8"), re.MULTILINE)) is None
        or match[1] != VERSION
    ]
