import asyncio

import pytest

from server.driving.arbiter import ControlArbiter
from server.driving.shell_control import in_control, renew_control
from server.platform.running_server import announce, ask
from server.platform.settings import SetupError
from tests.server.driving.pages import free, open_page
from tests.server.serving import Served


@pytest.fixture
async def served(served: Served) -> Served:
    """A server that commands find, of which nobody has control."""
    announce(served.settings)
    await free(served)
    return served


def command(served: Served, *, over: bool = False) -> None:
    """Arm the robot, as a command in a shell does it."""
    folder = served.settings.data
    with in_control(folder, over=over):
        ask(folder, "POST", "/robot/commands/arm")
        renew_control(folder)
        ask(folder, "POST", "/robot/commands/arm")


async def test_a_command_takes_control_and_releases_it(served: Served) -> None:
    await asyncio.to_thread(command, served)
    assert served.runtime.asked == [("arm", {})] * 2
    assert served.get(ControlArbiter).state().holder is None


async def test_a_command_does_not_take_control_over(served: Served) -> None:
    async with open_page(served) as page:
        await page.ask("/control/take")
        with pytest.raises(SetupError, match=r"Control is with the shell of this .* with --take-over"):
            await asyncio.to_thread(command, served)
        assert served.runtime.asked == []
        assert served.get(ControlArbiter).lease.holder == page.client


async def test_a_command_takes_control_over_on_purpose(served: Served) -> None:
    async with open_page(served) as page:
        await page.ask("/control/take")
        await asyncio.to_thread(command, served, over=True)
        assert served.runtime.asked == [("arm", {})] * 2
        assert served.get(ControlArbiter).lease.holder is None


async def test_a_command_whose_control_is_taken_over_does_not_take_it_back(served: Served) -> None:
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
