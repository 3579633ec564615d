"""The version: server.VERSION is the one place; whatever must repeat it says the same."""

import re
from pathlib import Path

from server import VERSION

REPEATED = {
    "firmware/library.properties": r"^version=(.*)$",
    "CHANGELOG.md": r"^## \[(\d.*?)\]",
}
"""Files, and where the version stands in them; the newest release comes first."""
NAMED = r"\bmucat(?:-lab)?[-_:](\d+\.\d+\.\d+)"
"""The version in the name of a file or image."""
FILES = ("README.md", "docs/**/*.md", "packages/**/*.yaml")
"""Files that name such files and images."""


def find_other_versions(root: Path) -> list[str]:
    """Return one line for each file whose version is not the program's."""
    repeated = {
        name: re.search(pattern, (root / name).read_text(encoding="utf-8"), re.MULTILINE)
        for name, pattern in REPEATED.items()
    }
    versions = [(name, match[1] if match else "nothing") for name, match in repeated.items()]
    versions += [
        (file.relative_to(root).as_posix(), version)
        for pattern in FILES
        for file in sorted(root.glob(pattern))
        for version in re.findall(NAMED, file.read_text(encoding="utf-8"))
    ]
    return [
        f"{name} says version {version}, server/__init__.py {VERSION}"
        for name, version in dict.fromkeys(versions)
        if version != VERSION
    ]
