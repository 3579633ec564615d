"""A release as a Debian package.

It carries the release's folder; its scripts call the release's own installer, the updater of the version in
use, and the uninstaller. What is installed is the same as by `install.sh`.
"""

import shutil
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from packages.architectures import ARCHITECTURES
from packages.commands import run
from robot_runtime.places import PACKAGES
from server.features.installation.environments import FROM_APT
from server.features.installation.places import InstallPlaces
from server.features.installation.release import read_release

ARCHITECTURES_32_BITS = {"armv6l": "armhf", "armv7l": "armhf"}
"""Debian's names of those without an emulated board; Raspberry Pi OS has the first one, too."""
FOLDER = Path("usr/lib/mucat/release")
CONTROL = """Package: {package}
Version: {version}
Architecture: {architecture}
Maintainer: µ-CAT <mucat@localhost>
Section: science
Priority: optional
Installed-Size: {kilobytes}
Depends: {depends}
Recommends: {recommends}
Conflicts: {conflicts}
Description: {description}
"""
INSTALL = """#!/bin/sh
# Installs the release, or updates the version in use. Boot settings stay; sudo mucat install asks for them.
set -e
test "$1" = configure || exit 0
installed=$(readlink {current} || true)
case "${{installed##*/}}" in
    "" | {version}) echo n | sh /{folder}/install.sh{option} ;;
    *) {command} update /{folder} ;;
esac
"""
REMOVE = """#!/bin/sh
# Removes services and software; data and configuration stay until the package is purged. An armed robot is
# refused by the uninstaller, and its status ends dpkg's work.
set -e
test "$1" = remove || exit 0
test ! -x {command} || {command} uninstall
"""
PURGE = """#!/bin/sh
set -e
test "$1" = purge || exit 0
# Installed again by other means than this package.
test ! -x {command} || {command} uninstall
rm -rf {software} {settings} {data} {report} {lock}
if getent passwd mucat >/dev/null; then userdel mucat; fi
"""


def build_debian_package(release: Path, machine: str, python: str, *, lab: bool = False) -> Path:
    """Build the package of a release's folder, for a machine and its Python, beside it. Return its path.

    Raise PackagingError.
    """
    version = read_release(release).version
    goal = release.with_name(f"{release.name}.deb")
    with TemporaryDirectory(dir=release.parent) as name:
        root = Path(name)
        root.chmod(0o755)
        # Copies, since the modes are the package's own.
        shutil.copytree(release, root / FOLDER, copy_function=shutil.copyfile)
        for file in (root / FOLDER).iterdir():
            file.chmod(0o644)
        _add_licence(root, _name(lab=lab))
        kilobytes = sum(file.stat().st_size for file in root.rglob("*") if file.is_file()) // 1024
        control = root / "DEBIAN"
        control.mkdir()
        (control / "control").write_text(_describe(version, machine, python, kilobytes, lab=lab))
        for script, text in _scripts(version, lab=lab).items():
            (control / script).write_text(text)
            (control / script).chmod(0o755)
        # Wheels are packed already.
        run(["dpkg-deb", "--build", "--root-owner-group", "-Znone", root, goal], "sudo apt install dpkg")
    return goal


def _name(*, lab: bool) -> str:
    return "mucat-lab" if lab else "mucat"


def _add_licence(root: Path, package: str) -> None:
    folder = root / "usr/share/doc" / package
    folder.mkdir(parents=True)
    shutil.copy(PACKAGES / "LICENSE", folder / "copyright")


def _describe(version: str, machine: str, python: str, kilobytes: int, *, lab: bool) -> str:
    major, minor = map(int, python.split("."))
    depends = [
        f"python3 (>= {python})",
        f"python3 (<< {major}.{minor + 1})",
        "python3-venv",
        "openssl",
        "systemd",
    ]
    recommends = ["avahi-daemon"]
    if not lab:
        depends.append("avrdude")
        # Raspberry Pi OS has it, Debian does not.
        recommends.append("python3-picamera2")
    if machine in ARCHITECTURES_32_BITS or machine == "i686":
        depends += [f"python3-{name}" for name in (*FROM_APT, "opencv")]
    architecture = ARCHITECTURES_32_BITS.get(machine) or ARCHITECTURES[machine].debian
    return CONTROL.format(
        package=_name(lab=lab),
        version=version,
        architecture=architecture,
        kilobytes=kilobytes,
        depends=", ".join(depends),
        recommends=", ".join(recommends),
        conflicts=_name(lab=not lab),
        description="lab of robot turtles" if lab else "software of the underwater robot turtle µ-CAT",
    )


def _scripts(version: str, *, lab: bool) -> Mapping[str, str]:
    places = InstallPlaces(lab=lab)
    values = {name: getattr(places, name) for name in ("current", "command", "software", "settings", "data")}
    values |= {"report": places.report, "lock": places.lock, "folder": FOLDER, "version": version}
    values["option"] = " --lab" if lab else ""
    return {
        script: text.format(**values)
        for script, text in (("postinst", INSTALL), ("prerm", REMOVE), ("postrm", PURGE))
    }
