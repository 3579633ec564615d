"""`mucat pair` and `mucat access`, as somebody types them."""

import asyncio
from collections.abc import Callable

import pytest

from server.cli import main
from server.platform.running_server import announce
from server.platform.settings import Settings
from tests.server.serving import Served
from tests.server.sign_in.browsers import browser

Shell = Callable[..., str]


@pytest.fixture
def shell(settings: Settings, capsys: pytest.CaptureFixture[str]) -> Shell:
    def run(*arguments: str, status: int = 0) -> str:
        capsys.readouterr()
        common = ("--data", str(settings.data.path), "--config", str(settings.config))
        assert main([*arguments, *common]) == status
        spoken = capsys.readouterr()
        return spoken.err if status else spoken.out

    return run


async def test_shell_commands_pair_and_revoke_people_and_programs(shell: Shell, served: Served) -> None:
    announce(served.settings)

    async def say(*arguments: str, status: int = 0) -> str:
        return await asyncio.to_thread(shell, *arguments, status=status)

    assert "Nobody is paired yet" in await say("access", "list")
    for name, role in (("first", "operator"), ("second", "viewer")):
        report = await say("pair")
        # As the start says it.
        assert f"http://localhost:{served.settings.server.port}/#pair=" in report
        assert f"makes the browser {'an' if role == 'operator' else 'a'} {role}" in report
        async with browser(served, None, name) as visitor:
            code = report.partition("/#pair=")[2].split()[0]
            assert (await visitor.pair(code)).json()["identity"]["role"] == role
    assert "an operator" in await say("pair", "--role", "operator")
    assert await say("access", "promote", "2") == "“second” is an operator now.\n"
    assert await say("access", "demote", "1") == "“first” is a viewer now.\n"
    token = (await say("access", "token", "script", "--scope", "operate")).strip()
    async with browser(served, None) as program:
        headers = {"authorization": f"Bearer {token}"}
        assert (await program.api.post("/robot/stop", headers=headers)).status_code == 204
    listed = (await say("access", "list")).splitlines()
    assert all(" UTC  " in line for line in listed)
    assert [line.split()[:3] for line in listed] == [
        ["1", "viewer", "browser"],
        ["2", "operator", "browser"],
        ["3", "operator", "program"],
    ]
    assert [line.split()[-1] for line in listed] == ["first", "second", "script"]
    assert "is revoked" in await say("access", "revoke", "2")
    assert "no device 2" in await say("access", "revoke", "2", status=1)
    assert "an operator" in await say("pair")


def test_without_a_server_the_command_says_so(shell: Shell) -> None:
    assert "mucat run" in shell("pair", status=1)
