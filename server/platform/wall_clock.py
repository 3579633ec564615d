"""Jumps of the wall clock: a robot without a battery-backed clock has no correct time before it is set."""

import ctypes
import json
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from robot_runtime.clock import Clock, boot
from robot_runtime.durable_files import write_whole

DAY = 86_400.0
SOFTWARE_MADE = 1_760_000_000
"""s since 1970, October 2025; a clock before that has not been set since the computer started."""
TIME_ERROR = 5
"""Answer of adjtimex(2) while the clock is not synchronised."""
TIMEX_BYTES = 512
"""At least the size of `struct timex` on every architecture."""
JUMP_SECONDS = 60.0
"""Difference between wall clock and steady clock that counts as a jump."""
AWAY_SECONDS = DAY
"""Time for which a computer may have been off without a doubt about its clock."""
STORE_SECONDS = 600.0
"""Between two times that are stored: an SD card wears out."""


def is_set(utc: float) -> bool:
    """Return True for a time (UTC, s since 1970) that this software can have seen."""
    return utc >= SOFTWARE_MADE


def is_synchronised() -> bool:
    """Return True where the kernel says so; asking for it needs no right (adjtimex(2) without a mode)."""
    state = int(ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(TIMEX_BYTES)))
    return 0 <= state < TIME_ERROR


def was_suspended() -> bool:
    """Return True where the computer was suspended since its start, so that the steady clock stood still."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.monotonic() > 1.0


@dataclass(frozen=True, slots=True)
class _Known:
    """The time at the last check, and the s of running for which ages stay unknown.

    `boot` is the start of the computer from which `steady` counts; `by_boot`: the doubt came with a start of
    the computer, and goes where a time server has set the clock.
    """

    boot: str
    utc: float
    steady: float
    doubt: float = 0.0
    by_boot: bool = False


class WallClock:
    """The comparison of the wall clock with the steady one, also from one server to the next.

    After a jump, for a day of running, no age is known. A start of the computer counts as a jump where the
    wall clock went back, or ahead by more than `AWAY_SECONDS`, and no time server has set it. `path` is the
    file with the last known time.
    """

    def __init__(self, clock: Clock, path: Path) -> None:
        self._clock = clock
        self._path = path
        self._known: _Known | None = None
        self._stored: _Known | None = None

    def knows_ages(self, now: float) -> bool:
        """Return True where ages are known at this time (UTC, s since 1970)."""
        last = self._known or self._read()
        self._known = self._look(now, last)
        return self._known.doubt <= 0

    def store(self) -> None:
        """Store the time for the next server, if it has changed enough. Raise OSError."""
        known, stored = self._known, self._stored
        if known is None:
            return
        if stored is None or known.boot != stored.boot or abs(known.utc - stored.utc) >= STORE_SECONDS:
            write_whole(self._path, json.dumps(asdict(known)).encode(), 0o600)
            self._stored = known

    def _look(self, now: float, last: _Known | None) -> _Known:
        present = _Known(boot(), now, self._clock.now())
        if last is None:
            return present
        gone, ran = now - last.utc, 0.0
        if last.boot == present.boot:
            ran = present.steady - last.steady
            if abs(gone - ran) > JUMP_SECONDS:
                return replace(present, doubt=DAY)
        elif not -JUMP_SECONDS <= gone <= AWAY_SECONDS and not is_synchronised():
            return replace(present, doubt=DAY, by_boot=True)
        if last.doubt <= 0 or (last.by_boot and is_synchronised()):
            return present
        return replace(present, doubt=last.doubt - ran, by_boot=last.by_boot)

    def _read(self) -> _Known | None:
        try:
            self._stored = _Known(**json.loads(self._path.read_bytes()))
        except (OSError, ValueError, TypeError):
            return None
        return self._stored
