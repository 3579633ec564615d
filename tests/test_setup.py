"""First commands of a new user: the set-up's words where something is missing, and the README's."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PLAIN = (
    "sh",
    "printf",
    "id",
    "dirname",
    "ls",
    "node",
    "npm",
    "python3",
    "gcc",
    "avr-gcc",
    "avr-objcopy",
    "avrdude",
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A folder as the whole PATH, with links to what the set-up needs, but neither apt nor sudo."""
    for name in PLAIN:
        # A version manager's python3 is a script that needs more than itself.
        real = os.path.realpath(sys.executable) if name == "python3" else shutil.which(name)
        if real is not None:
            (tmp_path / name).symlink_to(real)
    return tmp_path


def set_up(path: Path) -> subprocess.CompletedProcess[str]:
    command = ["/bin/sh", str(ROOT / "setup.sh"), "run"]
    return subprocess.run(command, env={"PATH": str(path)}, capture_output=True, text=True, check=False)


def test_a_complete_machine_needs_nothing(path: Path) -> None:
    done = set_up(path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("node", "Node 20.19 or newer"),
        ("python3", "Python 3.11 or newer"),
        ("avr-gcc", "gcc-avr"),
        ("avrdude", "avrdude"),
    ],
)
def test_missing_programs_are_reported_in_one_line(path: Path, name: str, message: str) -> None:
    (path / name).unlink()
    done = set_up(path)
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert message in done.stderr


def test_an_old_node_is_named_with_its_version(path: Path) -> None:
    (path / "node").unlink()
    (path / "node").write_text('#!/bin/sh\n[ "$1" = -p ] && echo 18 || echo v18.19.0\n')
    (path / "node").chmod(0o755)
    done = set_up(path)
    assert done.returncode == 1
    assert "this machine has v18.19.0" in done.stderr


def test_every_make_command_of_the_documents_exists() -> None:
    texts = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    named = {
        match for text in texts for match in re.findall(r"(?m)(?:`|^)make ([a-z][a-z-]*)", text.read_text())
    }
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    assert {"run", "test"} <= named
    assert named <= targets


def test_make_run_takes_the_port_that_the_readme_names() -> None:
    done = subprocess.run(
        ["make", "--dry-run", "run", "PORT=8123"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert "mucat run --port 8123" in done.stdout
