"""install.sh of a release that did not arrive whole."""

import shutil
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from robot_runtime.places import PACKAGES

WHEEL = "mucat-1.0.0-py3-none-any.whl"


def missing(folder: Path) -> None:
    (folder / WHEEL).unlink()


def cut(folder: Path) -> None:
    (folder / WHEEL).write_bytes((folder / WHEEL).read_bytes()[:-30])


def damaged(folder: Path) -> None:
    data = bytearray((folder / WHEEL).read_bytes())
    data[60] ^= 0xFF
    (folder / WHEEL).write_bytes(data)


def without_a_library(_: Path) -> None:
    """The wheel is whole, and needs another one that is not there."""


@pytest.mark.parametrize("fault", [missing, cut, damaged, without_a_library])
def test_a_release_that_is_not_whole_is_refused_in_one_line(
    tmp_path: Path, fault: Callable[[Path], None]
) -> None:
    shutil.copy(PACKAGES / "packages/install.sh", tmp_path)
    with zipfile.ZipFile(tmp_path / WHEEL, "w", zipfile.ZIP_DEFLATED) as wheel:
        wheel.writestr("server/__init__.py", "")
        wheel.writestr("server/cli.py", "import a_library_of_another_wheel\n" * 100)
    fault(tmp_path)
    done = subprocess.run(
        ["sh", "install.sh"],
        cwd=tmp_path,
        env={"PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(f"{tmp_path} is not a whole release (")
    assert done.stderr.endswith("): copy it again.\n")
    assert done.stderr.count("\n") == 1
