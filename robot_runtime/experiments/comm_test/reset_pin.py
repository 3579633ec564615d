"""The board's reset pin, pulled before an upload."""

import time
from collections.abc import Callable
from pathlib import Path

from robot_runtime.simulation.boards.emulator_process import EmulatorClient

PULSE = 0.01
"""s; the chip needs 2.5 µs, a capacitor on the board more."""


class ResetError(Exception):
    """The reset pin cannot be pulled; the text says why and what to do."""


Pull = Callable[[], None]


def find_reset(spec: str) -> Pull:
    """Return the function that pulls the reset pin: `gpio:CHIP:LINE`, `board:SOCKET` or `dtr` (by avrdude).

    Raise ResetError where `spec` is none of these; the returned function raises ResetError and BoardError.
    """
    kind, _, where = spec.partition(":")
    chip, _, line = where.rpartition(":")
    if spec == "dtr":
        return lambda: None
    if kind == "board" and where:
        return lambda: _pull_board(Path(where))
    if kind == "gpio" and chip and line.isdecimal():
        return lambda: _pull_gpio(chip, int(line))
    raise ResetError(f"link.reset is {spec!r}; it must be gpio:CHIP:LINE, board:SOCKET or dtr")


def _pull_board(socket: Path) -> None:
    with EmulatorClient(socket) as board:
        board.reset()


def _pull_gpio(chip: str, line: int) -> None:
    try:
        import gpiod  # only where there are such pins
    except ImportError as problem:
        raise ResetError("the package gpiod is missing: `pip install mucat[pi]` brings it") from problem
    value = gpiod.line.Value
    low = gpiod.LineSettings(
        direction=gpiod.line.Direction.OUTPUT, active_low=True, output_value=value.ACTIVE
    )
    try:
        with gpiod.request_lines(chip, consumer="mucat", config={line: low}) as request:
            time.sleep(PULSE)
            request.set_value(line, value.INACTIVE)
    except (OSError, ValueError) as problem:
        raise ResetError(f"the reset pin, line {line} of {chip}, cannot be pulled: {problem}") from problem
