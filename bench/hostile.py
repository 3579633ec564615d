"""The firmware's use of memory, and its worst loop with each hostile device while the line is full."""

import tempfile
from pathlib import Path

from bench.firmware import BAUD, FloodHost, count_flash
from bench.stack_bound import RAM_BYTES, count_static, stack_bound
from robot_runtime.contract.packets import StatusFlag
from robot_runtime.simulation.boards.emulator_process import FaultKind
from tests.board.host import FIRMWARE
from tests.board.rig import BoardRig

_SECONDS = 2.0
_AGAIN = 0.1
"""s after which a fault that mends itself comes again."""
_FAULTS: tuple[tuple[str, FaultKind], ...] = (
    ("imu", "absent"),
    ("imu", "dip"),
    ("pressure", "absent"),
    ("encoder0", "absent"),
    ("encoder0", "weak"),
    ("bridge0", "absent"),
    ("bridge0", "tripped"),
    ("i2c", "stuck"),
    ("i2c", "refused"),
    ("i2c", "stretched"),
    ("i2c", "contested"),
)
_MISTAKES = (
    "motors-swapped:front-right,back-right",
    "encoder-noise:2",
    "backlash:0.05",
    "gyro-offset:20,20,20",
)


def measure() -> dict[str, float]:
    """Return bytes by the linker and by analysis; stack and loop with each fault and some mistakes in turn.

    `stack_bound_bytes` is what no program flow exceeds, in the deepest interrupt; `stack_room_bytes` is what
    the memory has left for it. The robot is armed and swims, with the load of the part `firmware`, for two
    emulated seconds with each. A fault that mends itself comes again ten times a second.
    """
    elf = FIRMWARE / "robot.elf"
    static = count_static(elf)
    bound = stack_bound(elf)
    worst, missed, stack_free = _sweep(elf)
    return {
        "firmware.flash_bytes": count_flash(elf),
        "firmware.ram_static_bytes": static,
        "firmware.stack_room_bytes": RAM_BYTES - static,
        "firmware.stack_bound_bytes": bound,
        "firmware.stack_margin_bytes": RAM_BYTES - static - bound,
        "firmware.hostile_stack_bytes": RAM_BYTES - static - stack_free,
        "firmware.hostile_missed_ticks": missed,
        **{f"firmware.loop_worst_us.{name}": value for name, value in worst.items()},
    }


def _sweep(elf: Path) -> tuple[dict[str, float], int, int]:
    """Return the worst loop (us) by fault, missed ticks of all, and the least free stack."""
    worst: dict[str, float] = {}
    missed, stack_free = 0, RAM_BYTES
    for name, commands, clear in _cases():
        with tempfile.TemporaryDirectory() as folder, BoardRig(elf, Path(folder), baud=BAUD) as rig:
            host = FloodHost(rig, BAUD)
            host.arm()
            host.flood(0.5)
            host.worst = 0
            for _ in range(round(_SECONDS / _AGAIN)):
                for command in commands:
                    rig.board.command(command)
                host.flood(_AGAIN)
            rig.board.command(clear)
            host.flood(0.5)
            status = host.status
            if status is None or not status.flags & StatusFlag.ARMED:
                raise RuntimeError(f"the board did not stay armed with {name}")
            worst[name] = host.worst
            missed += status.missed_ticks
            stack_free = min(stack_free, status.stack_free)
    return worst, missed, stack_free


def _cases() -> list[tuple[str, list[str], str]]:
    faults = [
        (f"{device}_{kind}", [f"fault {device} {kind}"], f"fault {device} none") for device, kind in _FAULTS
    ]
    mistakes = [
        (mistake.partition(":")[0].replace("-", "_"), ["mistake none", f"mistake {mistake}"], "mistake none")
        for mistake in _MISTAKES
    ]
    return [*faults, *mistakes]
