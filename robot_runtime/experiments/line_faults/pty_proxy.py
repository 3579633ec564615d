"""A serial line with faults: a pseudo-terminal in front of a real port that damages passing bytes.

    python -m robot_runtime.experiments.line_faults.pty_proxy --port /dev/ttyAMA0 \
        --link /run/mucat/faulty --bit-errors 1e-4

The host opens the link instead of the port. What is harmed are bytes and not the wire: a wrong bit is one of
the eight of data, so that no framing errors arise. The emulated board does this on its wire.

On its standard input the program takes the commands `line`, `seed` and `stats` of the emulated board's
socket, which docs/reference/emulator.md describes.
"""

import argparse
import os
import select
import signal
import sys
import threading
import time
import tty
from pathlib import Path
from typing import Self

import serial

from robot_runtime.experiments.line_faults.faults import COUNTS, DIRECTIONS, KINDS, Direction, FaultyChannel
from robot_runtime.link.link_driver import PortError

_READ_BYTES = 1024
_STALL_MAX = 3600.0  # s
_CHECK_SECONDS = 0.1  # s between two looks whether the line has ended


class PtyProxy:
    """The pseudo-terminal at `link` and the port behind it, with a thread that carries bytes between them.

    Raises PortError where one of them cannot be opened. `failure` says why the line ended by itself.
    """

    def __init__(self, port: str, baud: int, link: Path, seed: int = 0) -> None:
        self.failure = ""
        self.channels: dict[Direction, FaultyChannel] = {
            name: FaultyChannel(name, seed) for name in DIRECTIONS
        }
        self._stalled_until: dict[Direction, float] = dict.fromkeys(DIRECTIONS, 0.0)
        self._pending = b""
        self._path, self._link = port, link
        try:
            self._port = serial.Serial(port, baud, timeout=0, exclusive=True)
        except (OSError, ValueError) as problem:
            raise PortError(f"cannot open {port}: {problem}") from problem
        self._host, self._terminal = os.openpty()
        self._wake_read, self._wake_write = os.pipe()
        tty.setraw(self._terminal)
        os.set_blocking(self._host, False)
        self._ending = False
        self._thread = threading.Thread(target=self._carry, name="fault line", daemon=True)
        try:
            self._make_link()
        except OSError as problem:
            self._close_files()
            raise PortError(f"cannot make {link}: {problem}") from problem
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the line and remove the link."""
        self._ending = True
        self._wake()
        self._thread.join()
        if self._link.is_symlink() and str(self._link.readlink()) == os.ttyname(self._terminal):
            self._link.unlink()
        self._close_files()

    def seed(self, seed: int) -> None:
        """Seed all faults from now on, in both directions."""
        for channel in self.channels.values():
            channel.seed(seed)

    def stall(self, direction: Direction, seconds: float) -> None:
        """Delay sent bytes for this many s. Raise ValueError for less than 0 s or more than an hour."""
        if not 0 <= seconds <= _STALL_MAX:
            raise ValueError("a stall lasts from 0 s to an hour")
        self.channels[direction].counts["stalls"] += seconds > 0
        self._stalled_until[direction] = time.monotonic() + seconds
        self._wake()

    def clean(self, direction: Direction) -> None:
        """Remove all faults of this direction."""
        self.channels[direction].clean()
        self._stalled_until[direction] = 0.0
        self._wake()

    def stats(self) -> dict[str, int]:
        """Return the counts of both directions, by names that begin with the direction."""
        channels = self.channels.items()
        return {f"{name}_{count}": channel.counts[count] for name, channel in channels for count in COUNTS}

    def running(self) -> bool:
        """Return True until the line ends by itself."""
        return self._thread.is_alive()

    def _make_link(self) -> None:
        if self._link.is_symlink():
            self._link.unlink()
        self._link.symlink_to(os.ttyname(self._terminal))

    def _close_files(self) -> None:
        self._port.close()
        for file in (self._host, self._terminal, self._wake_read, self._wake_write):
            os.close(file)

    def _wake(self) -> None:
        os.write(self._wake_write, b"\0")

    def _carry(self) -> None:
        try:
            while not self._ending:
                self._carry_once()
        except OSError as problem:
            self.failure = f"{self._path} went away: {problem}"

    def _carry_once(self) -> None:
        now, port = time.monotonic(), self._port.fileno()
        stalls = {name: end - now for name, end in self._stalled_until.items() if end > now}
        sources = [self._wake_read]
        if "to_board" not in stalls and not self._pending:
            sources.append(self._host)
        if "from_board" not in stalls:
            sources.append(port)
        sinks = [port] if self._pending else []
        ready, writable, _ = select.select(sources, sinks, [], min(stalls.values(), default=None))
        if self._wake_read in ready:
            os.read(self._wake_read, _READ_BYTES)
            return  # what has come since may have to wait
        if self._host in ready:
            self._pending += self.channels["to_board"].carry(os.read(self._host, _READ_BYTES))
        if port in writable:
            self._pending = self._pending[os.write(port, self._pending) :]
        if port in ready:
            self._pass_to_host(os.read(port, _READ_BYTES))

    def _pass_to_host(self, data: bytes) -> None:
        if not data:
            raise OSError("it has nothing more to say")
        channel = self.channels["from_board"]
        arriving = channel.carry(data)
        try:
            given = os.write(self._host, arriving)
        except BlockingIOError:
            given = 0
        channel.counts["lost"] += len(arriving) - given


def execute(line: PtyProxy, command: str) -> str:
    """Execute a command and return the answer. Raise ValueError for an invalid one."""
    match command.split():
        case ["stats"]:
            return " ".join(["stats", *(f"{name}={count}" for name, count in line.stats().items())])
        case ["seed", seed]:
            line.seed(int(seed))
        case ["line", ("to_board" | "from_board") as direction, *words]:
            _set_fault(line, direction, words)
        case _:
            raise ValueError("the commands are line, seed and stats")
    return "ok"


def _set_fault(line: PtyProxy, direction: Direction, arguments: list[str]) -> None:
    channel = line.channels[direction]
    match arguments:
        case [("bit_errors" | "drop" | "double" | "insert") as kind, rate]:
            channel.set_rate(kind, float(rate))
        case ["burst", rate, bits]:
            channel.burst(float(rate), int(bits))
        case ["stall", seconds]:
            line.stall(direction, float(seconds))
        case ["cut", ("on" | "off") as cut]:
            channel.cut(cut == "on")
        case ["clean"]:
            line.clean(direction)
        case _:
            raise ValueError("line takes a direction, and a kind of fault with its value")


def main() -> None:
    """Carry bytes until SIGTERM, SIGINT, or the port goes away."""
    arguments = _parser().parse_args()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: sys.exit(0))
    try:
        with PtyProxy(arguments.port, arguments.baud, arguments.link, arguments.seed) as line:
            for name in [arguments.direction] if arguments.direction else DIRECTIONS:
                for kind in KINDS:
                    line.channels[name].set_rate(kind, getattr(arguments, kind))
                line.channels[name].burst(arguments.burst[0], int(arguments.burst[1]))
            _serve(line)
            sys.exit(f"fault line: {line.failure}")
    except (PortError, ValueError) as problem:
        sys.exit(f"fault line: {problem}")


def _serve(line: PtyProxy) -> None:
    _print_line("ready")
    sources, rest = [sys.stdin.fileno()], b""
    while line.running():
        if not select.select(sources, [], [], _CHECK_SECONDS)[0]:
            continue
        data = os.read(sources[0], _READ_BYTES)
        if not data:
            sources = []
        *commands, rest = (rest + data).split(b"\n")
        for command in commands:
            try:
                _print_line(execute(line, command.decode(errors="replace")))
            except ValueError as problem:
                _print_line(f"error {problem}")


def _print_line(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m robot_runtime.experiments.line_faults.pty_proxy",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--port", required=True, help="the real port")
    parser.add_argument("--link", type=Path, required=True, help="what the host opens instead")
    parser.add_argument("--baud", type=int, default=250_000, help="of the real port; 250000 by default")
    parser.add_argument("--seed", type=int, default=0, help="from which the faults follow")
    parser.add_argument("--direction", choices=DIRECTIONS, help="harm only this one; both by default")
    parser.add_argument("--bit-errors", type=float, default=0.0, metavar="RATE", help="of the bits")
    for kind in ("drop", "double", "insert"):
        parser.add_argument(f"--{kind}", type=float, default=0.0, metavar="RATE", help="of the bytes")
    parser.add_argument(
        "--burst",
        type=float,
        nargs=2,
        default=(0.0, 1),
        metavar=("RATE", "BITS"),
        help="beginnings, of the bits",
    )
    return parser


if __name__ == "__main__":
    main()
