"""The server's greeting at its start, and the links in it."""

import asyncio
from dataclasses import replace

import pytest

from server.features.people.pairing_links import qr_text
from server.features.people.welcome import welcome
from server.http.sign_in.access import Access
from server.platform.settings import Settings
from tests.server.serving import Served, serve
from tests.server.sign_in.browsers import browser

PUBLIC = ("localhost", "127.0.0.1", "turtle.local", "192.168.0.7")


def lines(served: Served, settings: Settings, *, picture: bool = False) -> list[str]:
    return welcome(settings, served.get(Access), None, picture=picture)


def code_in(lines: list[str]) -> str:
    link = next(line for line in lines if "/#pair=" in line)
    return link.partition("/#pair=")[2]


def test_the_link_of_each_start_signs_this_computer_s_browser_in(settings: Settings) -> None:
    async def run() -> None:
        for number in (1, 2):
            async with serve(settings) as served, browser(served, None) as one:
                told = lines(served, served.settings)
                assert any("only this computer" in line for line in told)
                assert f"http://localhost:{served.settings.port}/#pair=" in "".join(told)
                answer = await one.pair(code_in(told))
                assert answer.json()["identity"]["role"] == "operator"
                assert len(served.get(Access).devices.all()) == number

    asyncio.run(run())


def test_on_a_network_address_a_link_is_printed_only_while_there_is_no_operator(settings: Settings) -> None:
    async def run() -> None:
        async with serve(settings) as served:
            public = replace(served.settings, host="0.0.0.0", allowed_hosts=PUBLIC)
            async with browser(served, "viewer"):
                told = lines(served, public, picture=True)
            link = f"http://turtle.local:{public.port}/#pair={code_in(told[:-1])}"
            assert told[-1] == qr_text(link)
            assert f"  http://192.168.0.7:{public.port}/#pair={code_in(told)}" in told
            assert any("every computer in all networks" in line for line in told)
            async with browser(served, "operator"):
                told = lines(served, public, picture=True)
            assert "pair=" not in "".join(told)

    asyncio.run(run())


def test_no_qr_code_for_the_loopback_address(settings: Settings) -> None:
    async def run() -> None:
        async with serve(settings) as served:
            assert not [line for line in lines(served, served.settings, picture=True) if "█" in line]

    asyncio.run(run())


@pytest.mark.parametrize(
    ("host", "names", "called", "base"),
    [
        ("127.0.0.1", ("localhost", "127.0.0.1"), "", "http://localhost:8000"),
        ("127.0.0.1", ("localhost", "127.0.0.1"), "127.0.0.1", "http://127.0.0.1:8000"),
        ("127.0.0.1", ("localhost", "127.0.0.1"), "evil.example", "http://localhost:8000"),
        ("0.0.0.0", ("localhost", "turtle.local", "192.168.0.7"), "", "http://turtle.local:8000"),
        ("0.0.0.0", ("localhost", "turtle.local", "192.168.0.7"), "192.168.0.7", "http://192.168.0.7:8000"),
        ("0.0.0.0", ("localhost", "turtle.local"), "localhost", "http://turtle.local:8000"),
        ("0.0.0.0", ("localhost", "turtle.local"), "10.78.0.1", "http://10.78.0.1:8000"),
        ("0.0.0.0", ("localhost", "turtle.local"), "127.0.0.1", "http://turtle.local:8000"),
        ("::", ("localhost", "turtle.local"), "[fd00::7]", "http://[fd00::7]:8000"),
        ("::1", ("[::1]",), "", "http://[::1]:8000"),
        ("192.168.0.7", ("localhost", "192.168.0.7"), "localhost", "http://192.168.0.7:8000"),
    ],
)
def test_links_use_an_address_that_others_can_reach(
    settings: Settings, host: str, names: tuple[str, ...], called: str, base: str
) -> None:
    chosen = replace(settings, host=host, allowed_hosts=names)
    assert chosen.base_url(called) == base
    assert chosen.only_here == (base.split("//")[1].rsplit(":", 1)[0] in ("localhost", "127.0.0.1", "[::1]"))
