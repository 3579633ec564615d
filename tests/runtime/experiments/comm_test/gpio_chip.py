"""A fake GPIO chip for other processes, by a library that they load: see gpio_chip.c."""

import fcntl
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

_SOURCE = Path(__file__).with_name("gpio_chip.c")
Level = tuple[str, float]


class GpioChip:
    """A chip of eight lines at `path`, for every process that the test starts from now on."""

    def __init__(self, folder: Path, environment: pytest.MonkeyPatch) -> None:
        library = folder / "gpio_chip.so"
        subprocess.run(["cc", "-shared", "-fPIC", "-O2", "-o", library, _SOURCE, "-ldl"], check=True)
        self.path = folder / "gpiochip0"
        self.path.symlink_to("/dev/null")
        self._lines = folder / "lines"
        self._lines.mkdir()
        environment.setenv("LD_PRELOAD", str(library))
        environment.setenv("MUCAT_GPIO_LINES", str(self._lines))

    def levels(self, line: int) -> list[Level]:
        """Return the changes of a line, in order, with their times (s, steady clock)."""
        file = self._lines / str(line)
        parts = [row.split() for row in file.read_text().splitlines()] if file.exists() else []
        return [(what, int(time) / 1e9) for what, time in parts]

    @contextmanager
    def hold(self, line: int) -> Iterator[None]:
        """Mark this line as requested by another program."""
        with (self._lines / str(line)).open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            yield
