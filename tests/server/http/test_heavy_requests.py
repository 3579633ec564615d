"""Turns of requests that cost much."""

import asyncio

import pytest

from server.http.heavy_requests import WAITING_MAX, HeavyRequests, TooManyHeavyError


def test_a_device_has_one_heavy_request_at_a_time_and_few_that_wait() -> None:
    async def scenario() -> None:
        heavy = HeavyRequests()
        begun: list[tuple[int, int]] = []
        gates = [asyncio.Event() for _ in range(WAITING_MAX + 1)]

        async def ask(device: int, number: int) -> None:
            async with heavy.turn(device):
                begun.append((device, number))
                await gates[number].wait()

        tasks = [asyncio.create_task(ask(1, number)) for number in range(WAITING_MAX + 1)]
        await asyncio.sleep(0)
        assert begun == [(1, 0)]
        with pytest.raises(TooManyHeavyError, match="Wait for their answers"):
            async with asyncio.timeout(10):
                await ask(1, 0)
        other = asyncio.create_task(ask(2, 0))
        await asyncio.sleep(0)
        assert begun == [(1, 0), (2, 0)]
        for gate in gates:
            gate.set()
        await asyncio.gather(other, *tasks)
        assert [number for device, number in begun if device == 1] == list(range(WAITING_MAX + 1))
        await ask(1, 0)

    asyncio.run(scenario())
