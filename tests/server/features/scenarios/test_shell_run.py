"""A queued run of the running server, followed from a shell."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from server.features.scenarios.runs import ScenarioRunner
from server.features.scenarios.shell_run import _follow
from server.platform.running_server import announce
from server.platform.settings import Settings, SetupError
from tests.server.features.scenarios.test_simulated_run import LONG
from tests.server.serving import Served, serve
from tests.waiting import SECONDS

TAKEN_OUT = "The run was taken out of the queue."


async def left_after(
    settings: Settings, change: Callable[[Served, str], Awaitable[None]], interrupt: bool
) -> list[int]:
    """Follow the second of two runs until it is taken out of the queue; return which of them stay."""
    async with serve(settings) as served:
        announce(served.settings)
        start = {"text": LONG, "place": "simulated"}
        runs = [(await served.api.post("/scenarios/runs", json=start)).json()["run"] for _ in range(2)]
        loop, polled = asyncio.get_running_loop(), asyncio.Event()

        def poll() -> None:
            if interrupt and polled.is_set():
                raise KeyboardInterrupt
            loop.call_soon_threadsafe(polled.set)

        following = asyncio.create_task(asyncio.to_thread(_follow, runs[1], settings.data, poll))
        await polled.wait()
        await change(served, runs[1])
        with pytest.raises(SetupError, match=TAKEN_OUT):
            async with asyncio.timeout(SECONDS):
                await following
        state = served.get(ScenarioRunner).state()
        return [runs.index(record.run) + 1 for record in (state.active, *state.queued) if record is not None]


async def test_a_run_that_somebody_takes_out_of_the_queue_ends_the_command(settings: Settings) -> None:
    async def cancel(served: Served, run: str) -> None:
        (await served.api.post(f"/scenarios/cancel?run={run}")).raise_for_status()

    assert await left_after(settings, cancel, interrupt=False) == [1]


async def test_ctrl_c_cancels_the_commands_own_run_alone(settings: Settings) -> None:
    async def nothing(_: Served, __: str) -> None:
        pass

    assert await left_after(settings, nothing, interrupt=True) == [1]
