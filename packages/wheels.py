"""`python -m packages.wheels [ARCHITECTURE ...]`: builds the wheels into the folder `dist`.

`mucat` is the same for every computer; `mucat-emulator` has programs, so that each architecture has its own.
Both put their files into the folder `mucat_build`, where the software finds them (robot_runtime/places.py).
`mucat-client` has those files of `mucat` that a program on another computer needs, and replaces it there.
"""

import argparse
import fcntl
import platform
import re
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from packages.architectures import ARCHITECTURES, Architecture, PackagingError
from packages.commands import run
from packages.constraints import write_constraints
from packages.sysroot import TOOLS, make_sysroot
from robot_runtime.places import BUILD, PACKAGES
from robot_runtime.simulation.boards.firmware import FirmwareBuildError, build_firmware, firmware_path
from server import VERSION

BAUDS = (250_000, 115_200)
"""bit/s for which firmware is packaged: the default, and one that every serial port can make."""
PYTHON_PACKAGES = ("mucat", "robot_runtime", "server", "migrations")
FILES = ("pyproject.toml", "README.md", "LICENSE", "firmware/emulator/LICENSE")
CLIENT_FILES = (
    "mucat",
    "robot_runtime/__init__.py",
    "robot_runtime/py.typed",
    "robot_runtime/contract",
    "robot_runtime/transport/__init__.py",
    "robot_runtime/transport/blocks.py",
    "robot_runtime/zip_members.py",
)
"""The package `mucat` without its environments, and what it imports."""
DIST = PACKAGES / "dist"
STAGES = BUILD / "wheels"
"""Copies of what goes into each wheel."""
GLIBC_SYMBOL = re.compile(r"\(GLIBC_(\d+)\.(\d+)")
GLIBC_MIN = (2, 17)
"""The oldest glibc that pip has a short tag for, manylinux2014."""


def main() -> int:
    """Build `mucat`, `mucat-client`, and `mucat-emulator` for this computer or the architectures named."""
    parser = argparse.ArgumentParser(prog="python -m packages.wheels", description=__doc__)
    parser.add_argument("architectures", nargs="*", metavar="ARCHITECTURE", help=", ".join(ARCHITECTURES))
    names = parser.parse_args().architectures or [platform.machine()]
    try:
        unknown = [name for name in names if name not in ARCHITECTURES]
        if unknown:
            raise PackagingError(
                f"There is no emulator for {unknown[0]}; there is for {', '.join(ARCHITECTURES)}."
            )
        print(build_mucat(DIST), build_client(DIST), sep="\n")
        for name in names:
            print(build_emulator(ARCHITECTURES[name], DIST))
        print(*write_constraints(DIST), sep="\n")
    except PackagingError as problem:
        print(problem, file=sys.stderr)
        return 1
    return 0


def build_mucat(dist: Path) -> Path:
    """Build the wheel with page, help, migrations, default configuration and firmware, into `dist`.

    Return its path. Raise PackagingError.
    """
    with _stage("mucat") as stage:
        _fill_mucat(stage)
        return _build(stage, dist)


def _fill_mucat(stage: Path) -> None:
    for package in PYTHON_PACKAGES:
        shutil.copytree(PACKAGES / package, stage / package, ignore=shutil.ignore_patterns("__pycache__"))
    for file in FILES:
        (stage / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(PACKAGES / file, stage / file)
    for built in ("server/page/index.html", "server/help/index.html"):
        if not (stage / built).exists():
            raise PackagingError(f"There is no {built}; `make wheels` builds it.")
    parts = stage / "mucat_build"
    for baud in BAUDS:
        for hil in (False, True):
            _copy_firmware(parts, baud, hil=hil)
    shutil.copy(BUILD / "firmware/optiboot.hex", parts / "firmware")
    shutil.copy(PACKAGES / "robot.toml", parts)


def _copy_firmware(parts: Path, baud: int, *, hil: bool) -> None:
    try:
        build_firmware(BUILD, baud, hil=hil)
    except FirmwareBuildError as problem:
        raise PackagingError(str(problem)) from problem
    goal = firmware_path(parts, baud, ".elf", hil=hil)
    goal.parent.mkdir(parents=True, exist_ok=True)
    program = firmware_path(BUILD, baud, ".elf", hil=hil)
    # Most of an ELF file is for a debugger.
    run(["avr-objcopy", "--strip-debug", program, goal], TOOLS)
    shutil.copy(program.with_suffix(".hex"), goal.parent)
    if not hil:
        shutil.copy(program.with_name("bring_up.hex"), goal.parent)


def build_client(dist: Path) -> Path:
    """Build the wheel for programs on other computers, into `dist`. Return its path. Raise PackagingError."""
    with _stage("mucat-client") as stage:
        for name in CLIENT_FILES:
            source, goal = PACKAGES / name, stage / name
            goal.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, goal, ignore=shutil.ignore_patterns("__pycache__", "gym"))
            else:
                shutil.copy(source, goal)
        for file in (PACKAGES / "packages/client").iterdir():
            shutil.copy(file, stage)
        shutil.copy(PACKAGES / "LICENSE", stage)
        (stage / "VERSION").write_text(VERSION)
        return _build(stage, dist)


def build_emulator(architecture: Architecture, dist: Path) -> Path:
    """Build the wheel with the emulated board for an architecture, into `dist`. Return its path.

    Raise PackagingError.
    """
    with _stage(f"mucat-emulator-{architecture.machine}") as stage:
        _fill_emulator(stage, architecture)
        return _build(stage, dist)


def _fill_emulator(stage: Path, architecture: Architecture) -> None:
    for file in (PACKAGES / "packages/emulator").iterdir():
        shutil.copy(file, stage)
    shutil.copy(PACKAGES / "firmware/emulator/LICENSE", stage)
    (stage / "VERSION").write_text(VERSION)
    compiled = STAGES / f"emulator-{architecture.machine}"
    compiled.mkdir(parents=True, exist_ok=True)
    make = ["make", "--silent", "-C", str(PACKAGES / "firmware/emulator"), f"OUT={compiled}", "PORTABLE=1"]
    if not architecture.is_own:
        root = make_sysroot(architecture)
        make += [f"CC={architecture.tool('gcc')}", f"CXX={architecture.tool('g++')}", f"SYSROOT={root}"]
    run(make, TOOLS)
    parts = stage / "mucat_build"
    parts.mkdir()
    for name in ("board", "libhost_board.so"):
        run([architecture.tool("objcopy"), "--strip-unneeded", compiled / name, parts / name], TOOLS)
    # The board itself is linked statically.
    major, minor = _glibc(architecture, parts / "libhost_board.so")
    tag = f"manylinux_{major}_{minor}_{architecture.machine}"
    (stage / "setup.cfg").write_text(f"[bdist_wheel]\nplat_name = {tag}\n")


def _glibc(architecture: Architecture, library: Path) -> tuple[int, int]:
    """Return the version of glibc that a shared library needs."""
    symbols = run([architecture.tool("objdump"), "--dynamic-syms", library], TOOLS)
    return max([GLIBC_MIN, *((int(match[1]), int(match[2])) for match in GLIBC_SYMBOL.finditer(symbols))])


def _build(stage: Path, dist: Path) -> Path:
    out = stage / "dist"
    uv = [str(Path(sys.executable).with_name("uv")), "build", "--wheel", "--quiet"]
    uv += ["--build-constraints", str(PACKAGES / "constraints.txt"), "--out-dir", str(out), str(stage)]
    run(uv, "make setup")
    (made,) = out.glob("*.whl")
    dist.mkdir(exist_ok=True)
    return Path(shutil.move(made, dist / made.name))


@contextmanager
def _stage(name: str) -> Iterator[Path]:
    """Yield an empty folder for a wheel's files; another build of wheels waits meanwhile."""
    STAGES.mkdir(parents=True, exist_ok=True)
    with (STAGES / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        folder = STAGES / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        yield folder


if __name__ == "__main__":
    sys.exit(main())
