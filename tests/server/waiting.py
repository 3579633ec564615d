"""Waiting in the event loop for conditions with a deadline."""

import asyncio
import time
from collections.abc import Callable
from typing import Any

import psutil

from tests.waiting import SECONDS as SECONDS
from tests.waiting import pause

SOCKET_LIMITS: dict[str, Any] = {"open_timeout": SECONDS, "ping_timeout": SECONDS}
"""Options of a WebSocket's client; its own 10 s and 20 s may pass on a busy computer."""


async def until(condition: Callable[[], object], what: str, seconds: float = SECONDS) -> None:
    """Wait in the event loop until the condition holds. Fails with `what` when it never does."""
    begin = time.monotonic()
    end = begin + seconds
    while not condition():
        now = time.monotonic()
        assert now < end, f"waited {seconds:g} s in vain for {what}"
        await asyncio.sleep(pause(now - begin))
        begin = time.monotonic()


def alive(pid: int) -> bool:
    """Return True while a process runs; one that has ended and was not reaped yet does not."""
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False
