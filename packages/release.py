"""`python -m packages.release KEY [--machine aarch64] [--python 3.13]`: builds a signed release into `dist`.

A release is a folder with the wheel of mucat, those of everything that it needs on such a computer, their
checksums, the signature, the public key, and `install.sh`. Beside it lie the same as a ZIP file and as a
Debian package, and the signed checksums of all files of this version. A robot needs no network to install it.
One with 32 bits has NumPy, OpenCV and pydantic from apt.
"""

import argparse
import platform
import shutil
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

from packages.architectures import ARCHITECTURES, PackagingError
from packages.commands import run
from packages.constraints import SMALL, small_requirements
from packages.debian_package import build_debian_package
from packages.signing import PUBLIC_KEY, make_key, sign_downloads, sign_folder, write_public_key
from packages.wheels import DIST, build_emulator, build_mucat
from robot_runtime.places import PACKAGES
from server import VERSION

PLATFORMS = ("manylinux_2_34", "manylinux_2_28", "manylinux_2_17", "manylinux2014", "linux")
MACHINES = ("x86_64", "aarch64")
SMALL_MACHINES = ("armv6l", "armv7l", "i686")
"""With 32 bits."""
EXTRAS = ("pi", "film", "mqtt", "parquet", "identify", "ros2")
"""What an installed robot has besides, with 64 bits; with 32 only `mqtt` has wheels."""
LAB_EXTRAS = ("film", "parquet", "identify", "lab")
"""What a lab has besides, on a computer with 64 bits."""
PURE: tuple[str, ...] = ("cobs",)
"""Packages without wheels for every computer, which are plain Python where there is no C compiler."""
SMALL_PURE = (*PURE, "markupsafe")
"""The same with 32 bits."""


def main() -> int:
    """Build the release. Return 1 where it cannot."""
    parser = argparse.ArgumentParser(prog="python -m packages.release", description=__doc__)
    parser.add_argument("key", type=Path, help="the secret key; made where there is none")
    parser.add_argument("--machine", default=platform.machine(), choices=(*MACHINES, *SMALL_MACHINES))
    parser.add_argument("--python", help="3.11, ...; without it this computer's, for 32 bits Debian 13's")
    parser.add_argument("--lab", action="store_true", help="with what a lab needs, and no robot does")
    options = parser.parse_args()
    own = ".".join(platform.python_version_tuple()[:2])
    python = options.python or (SMALL["python_version"] if options.machine in SMALL_MACHINES else own)
    try:
        folder = build_release(options.key, options.machine, python, DIST, lab=options.lab)
        package = build_debian_package(folder, options.machine, python, lab=options.lab)
        sign_downloads(DIST, options.key)
    except PackagingError as problem:
        print(problem, file=sys.stderr)
        return 1
    print(folder, package, sep="\n")
    return 0


def build_release(secret: Path, machine: str, python: str, dist: Path, *, lab: bool = False) -> Path:
    """Build the folder of a release for robots or a lab; an older one of this name is replaced.

    Return its path. Raise PackagingError.
    """
    if lab and machine not in MACHINES:
        raise PackagingError(f"A lab needs a computer with 64 bits: {', '.join(MACHINES)}.")
    if machine in SMALL_MACHINES and python != SMALL["python_version"]:
        raise PackagingError(
            f"Computers with 32 bits need Debian 13, whose Python is {SMALL['python_version']}."
        )
    folder = dist / f"mucat-{'lab-' if lab else ''}{VERSION}-{machine}-python{python}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    wheel = build_mucat(dist)
    shutil.copy(wheel, folder)
    if machine in ARCHITECTURES:
        shutil.copy(build_emulator(ARCHITECTURES[machine], dist), folder)
    _gather(folder, wheel, machine, python, LAB_EXTRAS if lab else EXTRAS)
    shutil.copy(PACKAGES / "packages/install.sh", folder)
    if not secret.exists():
        make_key(secret)
    write_public_key(secret, folder / PUBLIC_KEY)
    sign_folder(folder, secret)
    # Wheels are packed already: the archive only joins them.
    with zipfile.ZipFile(folder.with_name(folder.name + ".zip"), "w", zipfile.ZIP_STORED) as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, f"{folder.name}/{file.name}")
    return folder


def _gather(folder: Path, wheel: Path, machine: str, python: str, extras: Sequence[str]) -> None:
    """Put the wheels of mucat's dependencies into the folder, in the pinned versions."""
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet"]
    pins = ["--constraint", str(PACKAGES / "constraints.txt")]
    if machine in SMALL_MACHINES:
        # pip would take what mucat needs on this computer.
        pure, requirements = SMALL_PURE, ["--no-deps", *small_requirements()]
    else:
        pure, requirements = PURE, [*pins, f"{wheel}[{','.join(extras)}]"]
    for package in pure:
        command = [*pip, "wheel", "--no-deps", "--no-cache-dir", "--no-binary", package, *pins]
        command += ["--wheel-dir", str(folder), package]
        run(["env", "CC=/bin/false", *command], "make setup", f"{package} could not be built")
    tags = [word for tag in PLATFORMS for word in ("--platform", f"{tag}_{machine}")]
    command = [*pip, "download", "--only-binary", ":all:", *tags, "--python-version", python]
    command += ["--find-links", str(folder), "--dest", str(folder), *requirements]
    run(command, "make setup", "The wheels could not be gathered")


if __name__ == "__main__":
    sys.exit(main())
