"""The emulated board as a process, and a connection to its socket. See docs/reference/emulator.md."""

import platform
import select
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO, Literal, Self

from robot_runtime.places import EMULATOR_REMEDY
from robot_runtime.simulation.boards.board_protocol import LineBuffer, read_fins, write_sense
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion

START_TIMEOUT = 10.0
"""s within which the board must be ready, and within which it must have ended."""
ANSWER_TIMEOUT = 60.0
"""s of real time for an answer; a `run` of many emulated seconds takes a while."""

Water = Callable[[FinMotion], Reading]
FaultKind = Literal[
    "none", "absent", "stuck", "weak", "tripped", "dip", "wet", "refused", "stretched", "contested"
]
"""Not every device has each; see docs/reference/emulator.md."""
LineDirection = Literal["to_board", "from_board"]
LineFault = Literal["bit_errors", "drop", "double", "insert"]

STILL_WATER = Reading(
    pressure=101325.0,
    temperature=20.0,
    force=(0.0, 0.0, -9.80665),
    rate=(0.0, 0.0, 0.0),
    beacon_right=False,
    beacon_left=False,
    battery=7.4,
)
"""The sensors' input until it is set."""


class BoardError(Exception):
    """The board did not start, has ended, or refused a command; the text says why."""


class EmulatorClient:
    """A connection to the board's socket. After `attach` it answers the board's `fins` lines."""

    def __init__(self, path: Path) -> None:
        """Connect. Raise BoardError if no board answers at `path`."""
        self._water: Water | None = None
        self._lines = LineBuffer()
        self._pending: list[str] = []
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(ANSWER_TIMEOUT)
        try:
            self._socket.connect(str(path))
        except OSError as problem:
            self._socket.close()
            raise BoardError(f"no emulated board answers at {path}: {problem}") from problem

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Disconnect; the board continues with the last values."""
        self._socket.close()

    def attach(self, period: float, water: Water) -> None:
        """Become the water: while it waits for an answer, `water` is called every `period` (emulated s).

        Raise BoardError if another connection is the water, or the period is impossible.
        """
        self._water = water
        self._send_checked(f"attach {period!r}")

    def sense(self, reading: Reading) -> None:
        """Set the quantities that the sensors measure from now on.

        Raise BoardError on impossible values, or if another connection is the water.
        """
        self._send_checked(write_sense(reading).strip())

    def fins(self) -> FinMotion:
        """Return the present motion of the fins."""
        return read_fins(f"fins {self._query_fins()}")

    def led(self) -> bool:
        """Return True if the LED is on."""
        return self._query_fins().endswith(" 1")

    def run(self, seconds: float) -> float:
        """Advance a paused board in emulated time, as fast as possible; return its time (s)."""
        self._send(f"run {seconds!r}")
        return float(self._answer("ok"))

    def stats(self) -> dict[str, float]:
        """Return the board's counters, by name."""
        self._send("stats")
        pairs = (pair.split("=") for pair in self._answer("stats").split())
        return {name: float(value) for name, value in pairs}

    def fault(self, device: str, kind: FaultKind) -> None:
        """Set or clear the fault of a device (imu, pressure, encoder0-3, bridge0-3, leak).

        Raise BoardError.
        """
        self.command(f"fault {device} {kind}")

    def mistake(self, text: str) -> None:
        """Add a mistake of `mistakes.MISTAKES`, or remove all by `none`. Raise BoardError."""
        self.command(f"mistake {text}")

    def disturb_line(self, direction: LineDirection, kind: LineFault, rate: float) -> None:
        """Set the probability of a fault for each bit (bit_errors) or character. Raise BoardError."""
        self.command(f"line {direction} {kind} {rate!r}")

    def burst_line(self, direction: LineDirection, rate: float, bits: float) -> None:
        """Set the probability that a burst begins at a bit; half of the bits in a burst are wrong."""
        self.command(f"line {direction} burst {rate!r} {bits!r}")

    def stall_line(self, direction: LineDirection, seconds: float) -> None:
        """Delay sent bytes by this much emulated time; nothing gets lost."""
        self.command(f"line {direction} stall {seconds!r}")

    def cut_line(self, direction: LineDirection, cut: bool) -> None:
        """Cut the wire, or restore it."""
        self.command(f"line {direction} cut {'on' if cut else 'off'}")

    def clean_line(self, direction: LineDirection) -> None:
        """Remove all faults of this direction."""
        self.command(f"line {direction} clean")

    def seed_line(self, seed: int) -> None:
        """Seed the faults of the line from now on."""
        self.command(f"seed {seed}")

    def turn(self, fin: int, angle: float) -> None:
        """Turn a fin by hand to this angle (rad). Raise BoardError."""
        self.command(f"turn {fin} {angle!r}")

    def reset(self) -> None:
        """Pull the reset pin."""
        self.command("reset")

    def brown_out(self, lost: float) -> None:
        """Reset the chip as a dip of its supply does; this share of its memory's bytes becomes random.

        Raise BoardError if the share is not within 0 to 1.
        """
        self.command(f"brownout {lost!r}")

    def power(self) -> None:
        """Switch the power off and on; flash memory and EEPROM keep their contents."""
        self.command("power")

    def load(self, elf: Path) -> None:
        """Upload another program and reset the board. Raise BoardError if it is invalid."""
        self.command(f"load {elf}")

    def command(self, command: str) -> None:
        """Send a command that is answered with a plain `ok`. Raise BoardError if it is refused."""
        self._send(command)
        self._answer("ok")

    def _send_checked(self, command: str) -> None:
        # The board answers this command only to refuse it, and always before it answers the next one.
        self._send(command)
        self._send("stats")
        try:
            self._answer("stats")
        except BoardError:
            self._answer("stats")
            raise

    def _query_fins(self) -> str:
        self._send("fins")
        return self._answer("ok")

    def _send(self, line: str) -> None:
        try:
            self._socket.sendall(line.encode() + b"\n")
        except OSError as problem:
            raise BoardError(f"the emulated board has ended: {problem}") from problem

    def _answer(self, expected: str) -> str:
        while True:
            line = self._next_line()
            word, _, rest = line.partition(" ")
            if word == "error":
                raise BoardError(rest)
            if word == "fins" and self._water:
                self._send(write_sense(self._water(read_fins(line))).strip())
            elif word == expected:
                return rest
            else:
                raise BoardError(f"the emulated board answered {line!r} where {expected!r} was expected")

    def _next_line(self) -> str:
        while not self._pending:
            try:
                data = self._socket.recv(4096)
            except OSError as problem:
                raise BoardError(f"the emulated board does not answer: {problem}") from problem
            if not data:
                raise BoardError("the emulated board has closed the connection")
            self._pending.extend(self._lines.feed(data))
        return self._pending.pop(0)


def check_emulator(program: Path) -> None:
    """Raise BoardError where the emulated board is missing or made for another kind of computer."""
    try:
        subprocess.run([program, "--help"], capture_output=True, check=True, timeout=START_TIMEOUT)
    except FileNotFoundError as problem:
        raise BoardError(f"There is no emulated board ({program}): {EMULATOR_REMEDY}.") from problem
    except (OSError, subprocess.SubprocessError) as problem:
        why = problem.strerror if isinstance(problem, OSError) else str(problem)
        where = f"{program} on {platform.machine()}"
        raise BoardError(f"The emulated board cannot run ({where}): {why}; {EMULATOR_REMEDY}.") from problem


class EmulatorProcess:
    """The emulator's process; ends with the `with` statement. It creates the paths `tty` and `socket`."""

    def __init__(self, program: Path, elf: Path | None, tty: Path, socket: Path, *options: str) -> None:
        """Start the emulator and wait until it is ready. Raise BoardError with the emulator's own message.

        Without an `elf` the flash memory holds only the boot loader, which `options` must name.
        """
        self.tty = tty
        self.socket = socket
        command = [str(program), "--tty", str(tty), "--socket", str(socket), *options]
        if elf:
            command += ["--elf", str(elf)]
        self._errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the process
        try:
            self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self._errors)
        except OSError as problem:
            self._errors.close()
            raise BoardError(f"cannot start {program}: {problem}; {EMULATOR_REMEDY}") from problem
        if self._first_line() != b"ready\n":
            self.stop()
            raise BoardError(self._output or "the emulated board ended without a message")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def connect(self) -> EmulatorClient:
        """Open a new connection to its socket."""
        return EmulatorClient(self.socket)

    def stop(self) -> int:
        """End the process by SIGTERM and return its exit status."""
        if self.process.poll() is None:
            self.process.terminate()
        status = self.process.wait(START_TIMEOUT)
        if self.process.stdout:
            self.process.stdout.close()
        if not self._errors.closed:
            self._errors.seek(0)
            self._output = self._errors.read().decode(errors="replace").strip()
            self._errors.close()
        return status

    _output = ""

    def _first_line(self) -> bytes:
        output = self.process.stdout
        deadline = time.monotonic() + START_TIMEOUT
        if output is None or not select.select([output], [], [], deadline - time.monotonic())[0]:
            return b""
        return output.readline()
