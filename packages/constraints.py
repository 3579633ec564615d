"""Constraint files for pip, with the versions that were tested, and without what only tests need."""

import sys
import tempfile
from pathlib import Path

from packaging.requirements import Requirement

from packages.commands import run
from robot_runtime.places import PACKAGES

EXTRAS = ("pi", "film", "scene", "mqtt", "parquet", "identify", "lab", "ros2", "gym")
DEBIAN = PACKAGES / "packages/debian-13.txt"
"""Versions that fit the packages of a 32-bit Debian 13, for which pip finds no wheels."""
FROM_APT = ("numpy", "opencv-python-headless", "pydantic", "pydantic-core")
"""What apt installs there, in whatever version it has."""
SMALL = {"platform_machine": "armv6l", "python_version": "3.13", "python_full_version": "3.13.0"}
"""The computer for which markers of requirements are evaluated: one with 32 bits and Debian 13."""


def write_constraints(dist: Path) -> list[Path]:
    """Write `constraints.txt` and `constraints-32bit.txt` into `dist`. Raise PackagingError."""
    dist.mkdir(exist_ok=True)
    extras = [word for extra in EXTRAS for word in ("--extra", extra)]
    whole = dist / "constraints.txt"
    whole.write_text(_resolve([*extras, "--constraints", str(PACKAGES / "constraints.txt")]))
    small = dist / "constraints-32bit.txt"
    small.write_text("".join(f"{line}\n" for line in small_requirements()))
    return [whole, small]


def small_requirements() -> list[str]:
    """Return the needs of mucat[mqtt] on a 32-bit Debian 13 besides apt's packages, as `NAME==VERSION`.

    Raise PackagingError.
    """
    pins = (PACKAGES / "constraints.txt").read_text().splitlines()
    own = {_name(line): line for line in DEBIAN.read_text().splitlines()}
    others = [line for line in pins if _name(line) not in (*own, *FROM_APT)]
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as merged:
        merged.write("\n".join([*others, *own.values()]) + "\n")
        merged.flush()
        options = ["--extra", "mqtt", "--python-version", SMALL["python_version"]]
        resolved = _resolve([*options, "--constraints", merged.name])
    needed = [Requirement(line) for line in resolved.splitlines()]
    return [
        f"{requirement.name}{requirement.specifier}"
        for requirement in needed
        if requirement.name not in FROM_APT
        and (requirement.marker is None or requirement.marker.evaluate(dict(SMALL)))
    ]


def _name(line: str) -> str:
    return line.partition("==")[0].strip()


def _resolve(options: list[str]) -> str:
    command = [str(Path(sys.executable).with_name("uv")), "pip", "compile", "--quiet", "--no-header"]
    command += ["--no-annotate", "--universal", str(PACKAGES / "pyproject.toml"), *options]
    return run(command, "make setup", "The versions do not fit together")
