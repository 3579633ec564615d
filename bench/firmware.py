"""The firmware: what it takes of the chip, and how it keeps its pace on the emulated board."""

import subprocess
import tempfile
from pathlib import Path

from robot_runtime.packets import Navigation
from tests.board.host import FIRMWARE, Robot, start

_RAM_BYTES = 2048
_SECONDS = 60.0
_SECTIONS_IN_RAM = (".data", ".bss", ".noinit")
_SECTIONS_IN_FLASH = (".text", ".data")


def measure() -> dict[str, float]:
    """Bytes by the linker; stack and loop from a minute of emulated swimming at full telemetry."""
    size = _sections()
    static = sum(size.get(name, 0) for name in _SECTIONS_IN_RAM)
    with tempfile.TemporaryDirectory() as folder, start("robot", Path(folder)) as rig:
        robot = Robot(rig)
        robot.listen(0.3)
        robot.arm()
        worst = 0.0
        for step in range(round(_SECONDS)):
            side = 1.0 if step % 2 else -1.0
            command = Navigation(x=0.5, y=0.0, z=side, roll=0.0, pitch=0.0, yaw=0.5 * side)
            robot.converse(1.0, command)
            worst = max(worst, robot.status().loop_worst)
        status = robot.status()
    return {
        "firmware.flash_bytes": sum(size.get(name, 0) for name in _SECTIONS_IN_FLASH),
        "firmware.ram_static_bytes": static,
        "firmware.stack_high_water_bytes": _RAM_BYTES - static - status.stack_free,
        "firmware.loop_worst_us": worst,
        "firmware.missed_ticks": status.missed_ticks,
    }


def _sections() -> dict[str, int]:
    command = ["avr-size", "-A", str(FIRMWARE / "robot.elf")]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    words = [line.split() for line in lines if line.startswith(".")]
    return {name: int(size) for name, size, *_ in words}
