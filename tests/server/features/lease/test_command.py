import asyncio
from collections.abc import Awaitable, Callable

import pytest

from server.features.lease.arbiter import ControlArbiter
from server.features.lease.command import in_control, renew_control
from server.platform.running_server import announce, ask
from server.platform.settings import Settings, SetupError
from tests.server.features.lease.pages import free, open_page
from tests.server.serving import Served, play


def with_address(scenario: Callable[[Served], Awaitable[None]]) -> Callable[[Served], Awaitable[None]]:
    async def run(served: Served) -> None:
        announce(served.settings)
        await free(served)
        await scenario(served)

    return run


def command(served: Served, *, over: bool = False) -> None:
    """Arm the robot, as a command in a shell does it."""
    folder = served.settings.data
    with in_control(folder, over=over):
        ask(folder, "POST", "/robot/commands/arm")
        renew_control(folder)
        ask(folder, "POST", "/robot/commands/arm")


def test_a_command_takes_control_and_releases_it(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        await asyncio.to_thread(command, served)
        assert served.runtime.asked == [("arm", {})] * 2
        assert served.get(ControlArbiter).state().holder is None

    play(settings, with_address(scenario))


def test_a_command_does_not_take_control_over(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        async with open_page(served) as page:
            await page.ask("/control/take")
            with pytest.raises(SetupError, match=r"Control is with the shell of this .* with --take-over"):
                await asyncio.to_thread(command, served)
            assert served.runtime.asked == []
            assert served.get(ControlArbiter).lease.holder == page.client

    play(settings, with_address(scenario))


def test_a_command_takes_control_over_on_purpose(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        async with open_page(served) as page:
            await page.ask("/control/take")
            await asyncio.to_thread(command, served, over=True)
            assert served.runtime.asked == [("arm", {})] * 2
            assert served.get(ControlArbiter).lease.holder is None

    play(settings, with_address(scenario))


def test_a_command_whose_control_is_taken_over_does_not_take_it_back(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        async with open_page(served) as page:

            def lose() -> None:
                folder = served.settings.data
                with in_control(folder, over=False):
                    asyncio.run_coroutine_threadsafe(page.ask("/control/take?over=true"), loop).result()
                    renew_control(folder)
                    ask(folder, "POST", "/robot/commands/arm")

            loop = asyncio.get_running_loop()
            with pytest.raises(SetupError, match="Control is with"):
                await asyncio.to_thread(lose)
            assert served.get(ControlArbiter).lease.holder == page.client

    play(settings, with_address(scenario))
