"""The reserve of the server's memory."""

import asyncio
import resource

import pytest

from robot_runtime.clock import SimulatedClock
from server.platform.memory_reserve import (
    LOOK_SECONDS,
    OPENED_BYTES,
    SHARE,
    TRIM_SECONDS,
    MemoryReserve,
    read_own_bytes,
)

LIMIT = 500_000_000


class ReservingProcess:
    """A process of this much memory, of which it can give some back."""

    def __init__(self) -> None:
        self.bytes = 0
        self.spare = 0
        self.trimmed = 0

    def own_bytes(self) -> int:
        return self.bytes

    def give_back(self) -> None:
        self.trimmed += 1
        self.bytes -= self.spare
        self.spare = 0


@pytest.fixture
def limits(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The soft limits of this process's memory that were in force, the newest last; none is set really."""
    soft = [LIMIT]
    monkeypatch.setattr(resource, "getrlimit", lambda _: (soft[-1], resource.RLIM_INFINITY))
    monkeypatch.setattr(resource, "setrlimit", lambda _, limit: soft.append(limit[0]))
    return soft


def test_memory_is_short_from_a_share_of_the_limit_on(limits: list[int]) -> None:
    clock, process = SimulatedClock(), ReservingProcess()
    reserve = MemoryReserve(clock, process.own_bytes, process.give_back)
    process.bytes = int(SHARE * LIMIT)
    assert not reserve.short
    process.bytes += 1
    clock.forward(LOOK_SECONDS)
    assert reserve.short
    process.bytes -= 1
    clock.forward(LOOK_SECONDS)
    assert not reserve.short
    assert limits == [LIMIT]


def test_what_was_freed_is_given_back_before_anything_is_refused(limits: list[int]) -> None:
    clock, process = SimulatedClock(), ReservingProcess()
    reserve = MemoryReserve(clock, process.own_bytes, process.give_back)
    process.bytes, process.spare = LIMIT, LIMIT // 2
    assert not reserve.short
    process.bytes = LIMIT
    clock.forward(LOOK_SECONDS)
    assert reserve.short
    assert process.trimmed == 1
    clock.forward(TRIM_SECONDS)
    assert reserve.short
    assert process.trimmed == 2
    assert limits == [LIMIT]


async def test_an_allocation_that_fails_in_the_event_loop_raises_the_limit_until_there_is_room(
    limits: list[int],
) -> None:
    clock, process = SimulatedClock(), ReservingProcess()
    reserve = MemoryReserve(clock, process.own_bytes, process.give_back)
    reported: list[object] = []

    def allocate() -> None:
        raise MemoryError

    process.bytes = LIMIT
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda _, context: reported.append(context.get("exception")))
    reserve.watch(loop)
    loop.call_soon(allocate)
    await asyncio.sleep(0)
    assert reserve.short
    assert isinstance(reported[0], MemoryError)
    assert limits == [LIMIT, LIMIT + OPENED_BYTES]
    process.bytes = LIMIT // 10
    clock.forward(LOOK_SECONDS)
    assert not reserve.short
    assert limits == [LIMIT, LIMIT + OPENED_BYTES, LIMIT]


def test_without_a_limit_memory_is_never_short(monkeypatch: pytest.MonkeyPatch) -> None:
    infinity = resource.RLIM_INFINITY
    monkeypatch.setattr(resource, "getrlimit", lambda _: (infinity, infinity))
    reserve = MemoryReserve(SimulatedClock(), lambda: 10**15)
    reserve.open()
    assert not reserve.short


def test_the_memory_of_this_process_is_read() -> None:
    before = read_own_bytes()
    block = bytearray(b"x") * 50_000_000
    assert 45_000_000 < read_own_bytes() - before < 55_000_000
    assert len(block) == 50_000_000
