"""Constraint files for pip, with the versions that were tested, and without what only tests need."""

import subprocess
import sys
from pathlib import Path

from packages.architectures import PackagingError
from robot_runtime.places import PACKAGES

EXTRAS = ("pi", "scene", "parquet", "identify", "ros2")
DEBIAN = PACKAGES / "packages/debian-13.txt"
"""Versions that fit the packages of a 32-bit Debian 13, for which pip finds no wheels."""
FROM_APT = ("numpy", "opencv-python-headless", "pydantic", "pydantic-core")
"""What apt installs there, in whatever version it has."""
PYTHON = "3.13"
"""Debian 13's."""


def write_constraints(dist: Path) -> list[Path]:
    """Writes `constraints.txt` and `constraints-32bit.txt` into `dist`. Raises PackagingError."""
    dist.mkdir(exist_ok=True)
    pins = PACKAGES / "constraints.txt"
    extras = [word for extra in EXTRAS for word in ("--extra", extra)]
    whole = dist / "constraints.txt"
    whole.write_text(_resolve(["--universal", *extras, "--constraints", str(pins)]))
    own = {_name(line): line for line in DEBIAN.read_text().splitlines()}
    others = [line for line in pins.read_text().splitlines() if _name(line) not in (*own, *FROM_APT)]
    merged = dist / "constraints-32bit.unfinished"
    merged.write_text("\n".join([*others, *own.values()]) + "\n")
    try:
        resolved = _resolve(["--python-version", PYTHON, "--constraints", str(merged)])
    finally:
        merged.unlink()
    small = dist / "constraints-32bit.txt"
    small.write_text("".join(f"{line}\n" for line in resolved.splitlines() if _name(line) not in FROM_APT))
    return [whole, small]


def _name(line: str) -> str:
    return line.partition("==")[0].strip()


def _resolve(options: list[str]) -> str:
    command = [str(Path(sys.executable).with_name("uv")), "pip", "compile", "--quiet", "--no-header"]
    command += ["--no-annotate", str(PACKAGES / "pyproject.toml"), *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise PackagingError(f"The versions do not fit together: {done.stderr.strip()}")
    return done.stdout
