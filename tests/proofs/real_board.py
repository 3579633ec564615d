"""An installed robot with a board: an emulated one outside the container, at a serial port within it.

An update whose firmware differs puts it onto the board, and the way back puts the older firmware back.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robot_runtime.places import BUILD
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from robot_runtime.simulation.boards.firmware import build_firmware, firmware_path
from server.features.board.previous_firmware import read_program, write_program
from server.features.installation.installer import set_values
from tests.proofs.container import SystemdContainer
from tests.proofs.small_computer import CONFIG, DATA, SERVICES
from tests.proofs.steps import Steps, ask_server

PORT = "/dev/ttyBOARD"
DIALOUT = 20
"""The group's number in Debian."""
UNUSED = slice(0x64, 0x68)
"""The last entry of the ATmega328P's interrupt table (SPM_READY), which the firmware does not use."""
MARK = bytes.fromhex("0c940000")
"""The entry of the later firmware: a jump to the start, where avr-gcc's default handler goes as well."""
LINK = """
print(*(one["state"] for one in ask(data, "GET", "/health")["parts"] if one["name"] == "link"))
"""


@contextmanager
def board(folder: Path, baud: int) -> Iterator[list[str]]:
    """Run the board; yield the options by which systemd-nspawn gives it to a container."""
    build_firmware(BUILD, baud)
    tty, socket = folder / "tty", folder / "socket"
    loader = ("--bootloader", str(BUILD / "firmware/optiboot.hex"))
    with EmulatorProcess(BUILD / "board", firmware_path(BUILD, baud, ".elf"), tty, socket, *loader):
        folder.chmod(0o755)
        socket.chmod(0o666)
        port = tty.resolve()
        os.chown(port, -1, DIALOUT)
        port.chmod(0o660)
        yield [f"--bind={port}:{PORT}", f"--bind={folder}:/board"]


def connect(config: str, baud: int) -> str:
    """Return the configuration of a robot that is connected to the board; a container has no camera."""
    values = {
        "mode": '"robot"',
        "port": f'"{PORT}"',
        "baud": str(baud),
        "reset": '"board:/board/socket"',
        "camera": '"card"',
    }
    return set_values(config, values)


def mark_firmware(path: Path) -> None:
    """Make another firmware of this one, which the robot runs as well."""
    program = bytearray(read_program(path))
    assert program[UNUSED] != MARK
    program[UNUSED] = MARK
    write_program(bytes(program), path)


def update_with_board(container: SystemdContainer, steps: Steps, older: str, later: str) -> None:
    """Connect the board, and let an update and the way back change its firmware."""
    config = container.root / CONFIG.lstrip("/")
    config.write_text(connect(config.read_text(), container.system.baud))
    previous = container.root / DATA.lstrip("/") / "firmware-previous.hex"

    def is_linked() -> bool:
        return container.order(ask_server(LINK))[1].strip() == "ok"

    steps.take("a robot with a board", f"systemctl restart {SERVICES}", "")
    steps.wait("it is linked", is_linked)
    steps.take(
        "update with other firmware", f"mucat update /releases/{later}.zip", f"µ-CAT {later} is in use"
    )
    steps.check("the older firmware was on the board", read_program(previous)[UNUSED] != MARK)
    steps.runs(later)
    steps.wait("it is linked", is_linked)
    steps.take("roll back with the firmware", "mucat rollback", f"µ-CAT {older} is in use")
    steps.check("the later firmware was on the board", read_program(previous)[UNUSED] == MARK)
    steps.runs(older)
    steps.wait("it is linked", is_linked)
