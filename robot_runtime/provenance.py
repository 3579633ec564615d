"""Hashes of the software and the firmware, stored with each recording."""

from functools import cache
from hashlib import sha256
from pathlib import Path

HASH_CHARACTERS = 16


@cache
def hash_software() -> str:
    """Return the first 16 hexadecimal digits of the SHA-256 of the runtime's Python sources and their names.

    It is the same wherever they are installed. Raise OSError.
    """
    return hash_sources(Path(__file__).parent)


def hash_sources(*roots: Path) -> str:
    """Return the same of all Python sources in these folders. Raise OSError."""
    made = sha256()
    for root in roots:
        for path in sorted(root.rglob("*.py")):
            content = path.read_bytes()
            made.update(f"{path.relative_to(root).as_posix()} {len(content)}\n".encode())
            made.update(content)
    return made.hexdigest()[:HASH_CHARACTERS]


def hash_firmware(program: Path) -> str:
    """Return the first 16 hexadecimal digits of a firmware file's SHA-256; empty without such a file."""
    try:
        return sha256(program.read_bytes()).hexdigest()[:HASH_CHARACTERS]
    except OSError:
        return ""
