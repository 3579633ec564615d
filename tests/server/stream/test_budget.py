"""The budget of a viewer's device."""

from types import SimpleNamespace

import pytest

from robot_runtime.clock import SimulatedClock
from server.http.sign_in.identity import SHELL, Identity
from server.stream import budget
from server.stream.budget import (
    RECEIVED_BURST,
    RECEIVED_PER_SECOND,
    SENT_BURST,
    SENT_BYTES,
    SENT_PER_SECOND,
    STREAM_BURST,
    STREAM_PER_SECOND,
    Allowance,
    Budgets,
)

VIEWER = Identity(7, "Viewer", "viewer", "program")


def test_an_amount_comes_back_with_time() -> None:
    clock = SimulatedClock()
    allowance = Allowance(clock, rate=10.0, most=100.0)
    assert allowance.spend(100.0) == 0
    assert allowance.spend(5.0) == pytest.approx(0.5)
    clock.forward(0.5)
    assert allowance.spend(0.0) == pytest.approx(0)
    clock.forward(1000.0)
    assert allowance.spend(101.0) == pytest.approx(0.1)


def wait_of(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Return the pauses that are taken; time stands still in them."""
    pauses: list[float] = []

    async def sleep(seconds: float) -> None:
        pauses.append(seconds)

    monkeypatch.setattr(budget, "asyncio", SimpleNamespace(sleep=sleep))
    return pauses


async def test_a_viewer_s_messages_wait_and_an_operator_s_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    pauses, budgets = wait_of(monkeypatch), Budgets(SimulatedClock())

    for caller in (VIEWER, SHELL):
        for _ in range(int(RECEIVED_BURST)):
            await budgets.of(caller).wait_to_receive()
    assert not pauses
    # Another connection of the same device.
    await Budgets.of(budgets, VIEWER).wait_to_receive()
    await budgets.of(SHELL).wait_to_receive()
    assert pauses == [pytest.approx(1 / RECEIVED_PER_SECOND)]


async def test_a_large_message_counts_as_several(monkeypatch: pytest.MonkeyPatch) -> None:
    pauses, budgets = wait_of(monkeypatch), Budgets(SimulatedClock())

    await budgets.of(VIEWER).wait_to_send(int(SENT_BURST - 1) * SENT_BYTES)
    assert not pauses
    await budgets.of(VIEWER).wait_to_send(SENT_BYTES)
    await budgets.of(SHELL).wait_to_send(10**9)
    assert pauses == [pytest.approx(2 / SENT_PER_SECOND)]


def test_a_viewer_s_connections_share_their_bytes_and_an_operator_s_do_not() -> None:
    budgets = Budgets(SimulatedClock())
    first, second = (budgets.of(VIEWER).open_stream() for _ in range(2))
    assert first.spend(STREAM_BURST) == 0
    assert second.spend(STREAM_PER_SECOND) == pytest.approx(1.0)
    first, second = (budgets.of(SHELL).open_stream() for _ in range(2))
    assert first.spend(STREAM_BURST) == 0
    assert second.spend(STREAM_BURST) == 0
