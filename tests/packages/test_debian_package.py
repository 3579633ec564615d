"""The Debian package of a release; `make debian` installs one."""

import subprocess
from pathlib import Path

import pytest

from packages.debian_package import build_debian_package

VERSION = "7.8.9"
WHEEL = f"mucat-{VERSION}-py3-none-any.whl"


def ask(*arguments: str | Path) -> str:
    return subprocess.run(["dpkg-deb", *arguments], check=True, capture_output=True, text=True).stdout


def build(folder: Path, machine: str, python: str, *, lab: bool = False) -> Path:
    release = folder / "mucat-7.8.9-computer"
    release.mkdir()
    for name in (WHEEL, "SHA256SUMS", "SHA256SUMS.sig", "release.pem", "install.sh"):
        (release / name).write_text(name)
        (release / name).chmod(0o600)
    return build_debian_package(release, machine, python, lab=lab)


def test_it_carries_the_release_for_everybody_to_read(tmp_path: Path) -> None:
    package = build(tmp_path, "x86_64", "3.11")
    assert package == tmp_path / "mucat-7.8.9-computer.deb"
    lines = [line.split() for line in ask("--contents", package).splitlines()]
    files = {line[-1]: (line[0], line[1]) for line in lines if not line[-1].endswith("/")}
    assert {Path(name).name for name in files} == {
        *(WHEEL, "SHA256SUMS", "SHA256SUMS.sig", "release.pem", "install.sh"),
        "copyright",
    }
    assert set(files.values()) == {("-rw-r--r--", "root/root")}
    assert all(line[:2] == ["drwxr-xr-x", "root/root"] for line in lines if line[-1].endswith("/"))
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == ["mucat-7.8.9-computer"]


def test_the_release_s_own_files_stay_as_they_are(tmp_path: Path) -> None:
    build(tmp_path, "x86_64", "3.11")
    assert {file.stat().st_mode & 0o777 for file in (tmp_path / "mucat-7.8.9-computer").iterdir()} == {0o600}


@pytest.mark.parametrize(
    ("machine", "python", "architecture", "depends"),
    [
        (
            "x86_64",
            "3.11",
            "amd64",
            "python3 (>= 3.11), python3 (<< 3.12), python3-venv, openssl, systemd, avrdude",
        ),
        (
            "armv6l",
            "3.13",
            "armhf",
            "python3 (>= 3.13), python3 (<< 3.14), python3-venv, openssl, systemd, avrdude, python3-numpy, "
            "python3-pydantic, python3-opencv",
        ),
    ],
)
def test_its_needs_are_those_of_the_computer(
    tmp_path: Path, machine: str, python: str, architecture: str, depends: str
) -> None:
    package = build(tmp_path, machine, python)
    fields = dict(line.split(": ", 1) for line in ask("--field", package).splitlines())
    assert (fields["Package"], fields["Version"], fields["Conflicts"]) == ("mucat", VERSION, "mucat-lab")
    assert (fields["Architecture"], fields["Depends"]) == (architecture, depends)


def test_a_lab_is_a_package_of_its_own(tmp_path: Path) -> None:
    package = build(tmp_path, "x86_64", "3.11", lab=True)
    assert ask("--field", package, "Package", "Conflicts") == "Package: mucat-lab\nConflicts: mucat\n"
    ask("--control", package, tmp_path / "control")
    assert "install.sh --lab" in (tmp_path / "control/postinst").read_text()


def test_an_armed_robot_is_not_removed(tmp_path: Path) -> None:
    ask("--control", build(tmp_path, "x86_64", "3.11"), tmp_path / "control")
    command = tmp_path / "mucat"
    command.write_text('#!/bin/sh\ntest "$*" = uninstall && echo "The robot is armed." >&2\nexit 1\n')
    command.chmod(0o755)
    script = (tmp_path / "control/prerm").read_text().replace("/usr/local/bin/mucat", str(command))
    done = subprocess.run(["sh", "-s", "remove"], input=script, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, "The robot is armed.\n")


def test_its_scripts_do_nothing_but_at_their_moment(tmp_path: Path) -> None:
    ask("--control", build(tmp_path, "x86_64", "3.11"), tmp_path / "control")
    for script, moment in (("postinst", "abort-upgrade"), ("prerm", "upgrade"), ("postrm", "remove")):
        done = subprocess.run(
            ["sh", tmp_path / "control" / script, moment], capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
