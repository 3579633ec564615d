import asyncio
from collections.abc import Awaitable, Callable

import pytest

from server.features.lease.command import in_control
from server.platform.running_server import announce
from server.platform.settings import Settings, SetupError
from tests.server.features.lease.test_control import free, open_page
from tests.server.serving import Served, play
from tests.server.waiting import until


def with_address(scenario: Callable[[Served], Awaitable[None]]) -> Callable[[Served], Awaitable[None]]:
    async def run(served: Served) -> None:
        announce(served.settings)
        await free(served)
        await scenario(served)

    return run


def command(served: Served, said: list[str]) -> None:
    """What a command in a shell does with the robot."""
    with in_control(served.settings.data, said.append) as seat:
        seat.ask("POST", "/robot/arm")
        seat.renew()


def test_a_command_takes_control_and_gives_it_back(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        said: list[str] = []
        await asyncio.to_thread(command, served, said)
        assert (said, served.runtime.asked) == ([], [("arm", {})])
        assert served.assembly.desk.state().holder is None

    play(settings, with_address(scenario))


def test_it_asks_who_has_control_and_says_so(settings: Settings) -> None:
    async def scenario(served: Served) -> None:
        async with open_page(served) as page:
            desk = served.assembly.desk
            await page.ask("/control/take")
            for answer in ("/control/refuse", "/control/release"):
                said: list[str] = []
                waiting = asyncio.create_task(asyncio.to_thread(command, served, said))
                await until(lambda: desk.lease.request is not None, "the request")
                await page.ask(answer)
                if answer == "/control/refuse":
                    with pytest.raises(SetupError, match="Control stays with the shell of this computer"):
                        await waiting
                    assert served.runtime.asked == []
                else:
                    await waiting
                    assert served.runtime.asked == [("arm", {})]
                assert said == ["Control is with the shell of this computer, who has 10 s to refuse ..."]

    play(settings, with_address(scenario))
