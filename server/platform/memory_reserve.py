"""The reserve of the server's own memory: work that can wait is refused before the limit is reached.

A process at its limit fails anywhere, also where it reads a STOP from a socket. So from a share of the limit
on it does what operates the robot, and nothing else.
"""

import asyncio
import ctypes
import logging
import resource
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from robot_runtime.clock import Clock

log = logging.getLogger(__name__)

SHARE = 0.55
"""Of the limit, from which on memory is short. The rest has room for what is under way already."""
OPENED_BYTES = 16_000_000
"""By which the limit is raised at the first allocation that fails, until memory is no longer short."""
LOOK_SECONDS = 0.1
TRIM_SECONDS = 2.0
PAGE_BYTES = resource.getpagesize()
_STATM = Path("/proc/self/statm")


SHORT = (
    "The server has little memory left, and does only what operates the robot: STOP, commands, control. "
    "Try again in a moment; close pages and programs that nobody needs."
)


def read_own_bytes() -> int:
    """Return the memory of this process alone, in bytes, that it has touched."""
    _, resident, shared, *_ = _STATM.read_text("ascii").split()
    return (int(resident) - int(shared)) * PAGE_BYTES


def give_back() -> None:
    """Return freed memory that the C library still holds to the system."""
    with suppress(AttributeError):  # a C library other than glibc
        ctypes.CDLL(None).malloc_trim(0)


class MemoryReserve:
    """The check for shortage of this process's memory. Without a limit there is none."""

    def __init__(
        self,
        clock: Clock,
        own_bytes: Callable[[], int] = read_own_bytes,
        give_back: Callable[[], None] = give_back,
    ) -> None:
        self._clock = clock
        self._own_bytes = own_bytes
        self._give_back = give_back
        self._limit, _ = resource.getrlimit(resource.RLIMIT_DATA)
        self._opened = False
        self._short = False
        self._looked = self._trimmed = float("-inf")

    @property
    def short(self) -> bool:
        """True while only requests that operate the robot are served."""
        now = self._clock.now()
        if self._limit != resource.RLIM_INFINITY and now - self._looked >= LOOK_SECONDS:
            self._looked = now
            self._see(self._is_above(now))
        return self._short

    def watch(self, loop: asyncio.AbstractEventLoop) -> None:
        """Open the reserve where an allocation fails in the event loop, which reports it as before."""
        report = loop.get_exception_handler() or type(loop).default_exception_handler

        def see(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
            if isinstance(context.get("exception"), MemoryError):
                self.open()
            report(loop, context)

        loop.set_exception_handler(see)

    def open(self) -> None:
        """Raise the limit after a failed allocation, so that running work can end."""
        if self._limit == resource.RLIM_INFINITY or self._opened:
            return
        self._opened = self._short = True
        self._looked = self._clock.now()
        self._set_limit(self._limit + OPENED_BYTES)
        log.error("The server has no memory left. %s", SHORT)

    def _is_above(self, now: float) -> bool:
        most = SHARE * self._limit
        if self._own_bytes() <= most:
            return False
        if now - self._trimmed >= TRIM_SECONDS:
            self._trimmed = now
            self._give_back()
        return self._own_bytes() > most

    def _see(self, short: bool) -> None:
        if short and not self._short:
            log.warning("%s", SHORT)
        if self._opened and not short:
            self._opened = False
            self._set_limit(self._limit)
        self._short = short

    def _set_limit(self, soft: int) -> None:
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        most = soft if hard == resource.RLIM_INFINITY else min(soft, hard)
        resource.setrlimit(resource.RLIMIT_DATA, (most, hard))
