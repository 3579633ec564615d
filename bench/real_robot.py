"""The software as on a robot: in mode robot, with an emulated board at its serial port."""

import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import psutil

from robot_runtime.clock import SteadyClock
from robot_runtime.places import BUILD
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from robot_runtime.simulation.boards.firmware import build_firmware, firmware_path
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import make_card
from server.features.bench.robot_processes import OUTSIDE, find_processes
from server.platform.settings import DataFolder
from tests.stack import Stack

_BAUD = 250_000
_CONFIG = """[robot]
mode = "robot"
profile = "{profile}"
[link]
port = "{port}"
baud = {baud}
[vision]
camera = "file"
file = "{picture}"
"""


class RealRobot(Stack):
    """Server and runtime as on a Raspberry Pi; board and water are processes outside, as the real ones are.

    The camera shows one picture, because to draw or render others is no work of a robot.
    """

    def __init__(self, data: Path, profile: str = "full") -> None:
        self._config = data / "robot.toml"
        super().__init__(data, "--config", str(self._config))
        self.outside: dict[str, psutil.Process] = {}
        """The processes of the board and of the water."""
        self._profile = profile
        self._ends = ExitStack()

    def __enter__(self) -> Self:
        with ExitStack() as opened:
            port, self.outside = opened.enter_context(board_outside(self.data, _BAUD))
            picture = self.data / "card.png"
            store_picture(picture)
            text = _CONFIG.format(profile=self._profile, port=port, baud=_BAUD, picture=picture)
            self._config.write_text(text)
            super().__enter__()
            self._ends = opened.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._ends:
            super().__exit__(kind, value, trace)

    @property
    def robot_processes(self) -> dict[str, psutil.Process]:
        """The processes of a robot, by name: also the one that compares, where it is there."""
        numbers = find_processes(self.process.pid, DataFolder(self.data).run)
        return {name: psutil.Process(pid) for name, pid in numbers.items() if name not in OUTSIDE}


@contextmanager
def board_outside(folder: Path, baud: int) -> Iterator[tuple[str, dict[str, psutil.Process]]]:
    """Run an emulated board and its water; yield the serial port, and the processes by name."""
    build_firmware(BUILD, baud)
    elf = firmware_path(BUILD, baud, ".elf")
    tty, socket = folder / "tty", folder / "board.sock"
    water = [sys.executable, "-m", "robot_runtime.simulation", "--board", str(socket), "--with-parent"]
    with (
        EmulatorProcess(BUILD / "board", elf, tty, socket, "--with-parent") as board,
        subprocess.Popen(water) as simulator,
    ):
        processes = {"board": board.process.pid, "simulator": simulator.pid}
        try:
            yield str(tty.resolve()), {name: psutil.Process(pid) for name, pid in processes.items()}
        finally:
            simulator.terminate()


def store_picture(file: Path) -> None:
    """Write the picture of a yellow card."""
    camera = CardCamera(320, 240, SteadyClock(), lambda: None)
    cv2.imwrite(str(file), camera.draw(0.0, make_card("yellow", {})))


def pids(processes: Mapping[str, psutil.Process]) -> dict[str, int]:
    """Return the process IDs, by the same names."""
    return {name: process.pid for name, process in processes.items()}
