"""The board with the bring-up's sketch, at the other end of the link."""

import threading
import time
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Protocol, Self

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.packets import Calibration, Jog, Packet, Raw, RequestScan, Scan, Stop
from robot_runtime.link.serial_link import SerialLink
from robot_runtime.link.session import BoardMessage

GREETING_SECONDS = 5.0
"""Time after an upload in which the sketch answers; the boot loader listens for 1 s first."""
ANSWER_SECONDS = 3.0
_READINGS_MOST = 1200
"""Readings kept, a minute of them."""


class BenchError(Exception):
    """The board does not answer; the text says what to do."""


class Bench(Protocol):
    """A board with the bring-up's sketch. Its methods raise BenchError where the board is silent."""

    def newest(self) -> Raw | None:
        """Return the newest reading, if it is fresh."""

    def readings(self, seconds: float) -> list[Raw]:
        """Return the readings of the next seconds, at least a few."""

    def mark(self) -> None:
        """Forget all readings until now."""

    def since_mark(self) -> list[Raw]:
        """Return the readings since the mark."""

    def scan(self) -> set[int]:
        """Return the I2C addresses that answer."""

    def jog(self, fin: int, drive: int) -> None:
        """Drive a motor for 250 ms; 0 stops it."""

    def store(self, calibration: Calibration) -> Calibration:
        """Store a calibration; return the board's calibration after that."""


class SerialBench:
    """The board at a serial port, in real time. Entering waits for its greeting."""

    def __init__(self, port: str, baud: int) -> None:
        self._heard = threading.Condition()
        self._raws: deque[Raw] = deque(maxlen=_READINGS_MOST)
        self._newest_at = 0.0
        self._scans: list[Scan] = []
        self._answers: list[Calibration] = []
        epoch = time.time_ns() // 1_000_000 & 0xFFFF
        self._link = SerialLink(port, baud, SteadyClock(), epoch, self._take, lambda: None)

    def __enter__(self) -> Self:
        self._link.start()
        try:
            self._await(lambda: bool(self._raws), GREETING_SECONDS)
        except BenchError:
            self._link.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._link.send(Stop())
        self._link.close()

    def newest(self) -> Raw | None:
        """See Bench."""
        with self._heard:
            fresh = time.monotonic() - self._newest_at < 1.0
            return self._raws[-1] if fresh and self._raws else None

    def readings(self, seconds: float) -> list[Raw]:
        """See Bench."""
        self.mark()
        end = time.monotonic() + seconds
        with self._heard:
            self._heard.wait_for(lambda: time.monotonic() >= end, seconds)
        self._await(lambda: len(self._raws) > 1)
        return self.since_mark()

    def mark(self) -> None:
        """See Bench."""
        with self._heard:
            self._raws.clear()

    def since_mark(self) -> list[Raw]:
        """See Bench."""
        with self._heard:
            return list(self._raws)

    def scan(self) -> set[int]:
        """See Bench."""
        self._scans.clear()
        self._send(RequestScan())
        self._await(lambda: bool(self._scans))
        return addresses(self._scans[-1])

    def jog(self, fin: int, drive: int) -> None:
        """See Bench."""
        self._send(Jog(fin=fin, drive=drive))

    def store(self, calibration: Calibration) -> Calibration:
        """See Bench."""
        self._answers.clear()
        self._send(calibration)
        self._await(lambda: bool(self._answers))
        return self._answers[-1]

    def _send(self, packet: Packet) -> None:
        if not self._link.send(packet):
            raise BenchError(f"There is no connection to the board: {self._link.text}.")

    def _await(self, condition: Callable[[], bool], seconds: float = ANSWER_SECONDS) -> None:
        with self._heard:
            if not self._heard.wait_for(condition, seconds):
                raise BenchError(
                    f"The board does not answer: {self._link.text}. Check its supply and its line."
                )

    def _take(self, messages: list[BoardMessage]) -> None:
        with self._heard:
            for message in messages:
                if message.type == Raw.type:
                    self._raws.append(Raw.from_bytes(message.payload))
                    self._newest_at = time.monotonic()
                elif message.type == Scan.type:
                    self._scans.append(Scan.from_bytes(message.payload))
                elif message.type == Calibration.type:
                    self._answers.append(Calibration.from_bytes(message.payload))
            self._heard.notify_all()


def addresses(scan: Scan) -> set[int]:
    """Return the addresses of a scan's answer."""
    return {address for address in range(128) if scan.answered[address // 8] >> address % 8 & 1}
