"""The wheels, installed into an environment without the repository on its path."""

import os
import subprocess
import sys
import sysconfig
from collections.abc import Mapping, Sequence
from pathlib import Path

from tests.waiting import SECONDS

UV = str(Path(sys.executable).with_name("uv"))


class Installation:
    """A virtual environment with wheels; what they depend on is taken from this one's packages."""

    def __init__(self, folder: Path, wheels: Sequence[Path]) -> None:
        self.wheels = wheels
        _run([UV, "venv", "--quiet", "--python", sys.executable, str(folder)])
        python = folder / "bin/python"
        _run([UV, "pip", "install", "--quiet", "--no-deps", "--python", str(python), *map(str, wheels)])
        (self.packages,) = folder.glob("lib/python*/site-packages")
        # A line of a .pth file adds a folder, but not what that folder's own .pth files add: the repository.
        (self.packages / "dependencies.pth").write_text(sysconfig.get_path("purelib"))
        self.program = folder / "bin/mucat"
        self.environment = {"PYTHONPATH": ""}

    def mucat(
        self, *arguments: str, cwd: Path, environment: Mapping[str, str] | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run a command of mucat in the folder `cwd`."""
        return subprocess.run(
            [str(self.program), *arguments],
            cwd=cwd,
            env={**os.environ, **self.environment, **(environment or {})},
            capture_output=True,
            text=True,
            check=False,
            timeout=SECONDS,
        )


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
