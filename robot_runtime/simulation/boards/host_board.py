"""The robot's firmware compiled for this computer, in this process, with the emulated board's own devices."""

import ctypes
from ctypes import POINTER, c_bool, c_char_p, c_double, c_int, c_uint8, c_uint32, c_uint64, c_void_p
from pathlib import Path
from typing import Any

from robot_runtime.places import EMULATOR_REMEDY
from robot_runtime.simulation.boards.emulator_process import BoardError, FaultKind, Water
from robot_runtime.simulation.boards.stepped_board import PERIOD, SteppedBoard
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion

_MILLISECONDS = round(1000 * PERIOD)
_RECEIVED_MAX = 4096
_DIRECTIONS = {"to_board": 0, "from_board": 1}
_STALL_MAX = 3600.0
_DOUBLES = POINTER(c_double)

# Result, then arguments of each function.
_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "board_create": (c_void_p,),
    "board_destroy": (None, c_void_p),
    "board_reset": (None, c_void_p),
    "board_send": (None, c_void_p, c_char_p, c_uint32),
    "board_run": (c_uint32, c_void_p, c_uint32, POINTER(c_uint8), c_uint32),
    "board_fins": (None, c_void_p, _DOUBLES),
    "board_sense": (c_bool, c_void_p, _DOUBLES),
    "board_fault": (c_bool, c_void_p, c_char_p, c_char_p),
    "board_mistake": (c_bool, c_void_p, c_char_p),
    "board_seed": (None, c_void_p, c_uint64),
    "board_disturb": (c_bool, c_void_p, c_int, c_char_p, c_char_p),
    "board_stall": (None, c_void_p, c_int, c_double),
}


class HostBoard(SteppedBoard):
    """The board in the shared library `path`. Computing takes none of its simulated time.

    Raises BoardError if the library cannot be loaded.
    """

    def __init__(self, path: Path, water: Water) -> None:
        self._water = water
        try:
            self.firmware = path.read_bytes()
            self._library = ctypes.CDLL(str(path.absolute()))
        except OSError as problem:
            raise BoardError(f"cannot load {path}: {problem}; {EMULATOR_REMEDY}") from problem
        for name, (result, *arguments) in _SIGNATURES.items():
            function = getattr(self._library, name)
            function.restype, function.argtypes = result, arguments
        self._board = self._library.board_create()
        self._received = (c_uint8 * _RECEIVED_MAX)()
        self._fins = (c_double * 13)()

    def run(self, periods: int) -> bytes:
        """Advance by this many periods; return the bytes for the host."""
        library, board, received, fins = self._library, self._board, self._received, self._fins
        data = b""
        for _ in range(periods):
            size = library.board_run(board, _MILLISECONDS, received, _RECEIVED_MAX)
            if size:
                data += bytes(memoryview(received)[:size])
            library.board_fins(board, fins)
            self._sense(self._water(FinMotion.of(list(fins))))
        return data

    def write(self, data: bytes) -> None:
        """Send these bytes to the board."""
        self._library.board_send(self._board, data, len(data))

    def fault(self, device: str, kind: FaultKind) -> None:
        """Set or clear the fault of a device."""
        if not self._library.board_fault(self._board, device.encode(), kind.encode()):
            raise BoardError(f"there is no device {device!r}, or no fault {kind!r}")

    def mistake(self, text: str) -> None:
        """Add a mistake of wiring, or an imperfection of a part."""
        if not self._library.board_mistake(self._board, text.encode()):
            raise BoardError(f"there is no mistake {text!r}")

    def line(self, command: str) -> None:
        """Set a fault of the line by a command such as `line to_board cut on`."""
        _, direction, kind, *rest = command.split()
        value = " ".join(rest)
        if kind == "stall":
            done = 0 <= float(value) <= _STALL_MAX
            if done:
                self._library.board_stall(self._board, _DIRECTIONS[direction], float(value))
        else:
            done = self._library.board_disturb(
                self._board, _DIRECTIONS[direction], kind.encode(), value.encode()
            )
        if not done:
            raise BoardError(f"unknown command: {command}")

    def seed_line(self, seed: int) -> None:
        """Seed the faults of the line."""
        self._library.board_seed(self._board, seed)

    def reset(self) -> None:
        """Pull the reset pin."""
        self._library.board_reset(self._board)

    def close(self) -> None:
        """End the board."""
        if self._board is not None:
            self._library.board_destroy(self._board)
            self._board = None

    def _sense(self, reading: Reading) -> None:
        numbers = (c_double * 16)(
            reading.pressure,
            reading.temperature,
            *reading.force,
            *reading.rate,
            reading.beacon_right,
            reading.beacon_left,
            reading.battery,
            *reading.encoders,
            reading.fin_load,
        )
        if not self._library.board_sense(self._board, numbers):
            raise BoardError(f"the board refused this reading of its sensors: {reading}")
