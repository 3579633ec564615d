"""The server's greeting at its start, and the links in it."""

from dataclasses import replace

import pytest

from server.http.sign_in.access import Access
from server.http.sign_in.pairing_links import qr_text
from server.http.sign_in.welcome import welcome
from server.platform.server_config import ServerConfig
from server.platform.settings import Settings
from tests.server.serving import Served, serve
from tests.server.sign_in.browsers import browser

PUBLIC = ["localhost", "127.0.0.1", "turtle.local", "192.168.0.7"]


def lines(served: Served, settings: Settings, *, picture: bool = False) -> list[str]:
    return welcome(settings, served.get(Access), None, picture=picture)


def code_in(lines: list[str]) -> str:
    link = next(line for line in lines if "/#pair=" in line)
    return link.partition("/#pair=")[2]


async def test_the_link_of_each_start_signs_this_computer_s_browser_in(settings: Settings) -> None:
    for number in (1, 2):
        async with serve(settings) as served, browser(served, None) as visitor:
            report = lines(served, served.settings)
            assert any("only this computer" in line for line in report)
            assert f"http://localhost:{served.settings.server.port}/#pair=" in "".join(report)
            answer = await visitor.pair(code_in(report))
            assert answer.json()["identity"]["role"] == "operator"
            assert len(served.get(Access).devices.all()) == number


async def test_on_a_network_address_a_link_is_printed_only_while_there_is_no_operator(served: Served) -> None:
    public = served.settings.with_section(
        replace(served.settings.server, host="0.0.0.0", allowed_hosts=PUBLIC)
    )
    async with browser(served, "viewer"):
        report = lines(served, public, picture=True)
    link = f"http://turtle.local:{public.server.port}/#pair={code_in(report[:-1])}"
    assert report[-1] == qr_text(link)
    assert f"  http://192.168.0.7:{public.server.port}/#pair={code_in(report)}" in report
    assert any("every computer in all networks" in line for line in report)
    async with browser(served, "operator"):
        report = lines(served, public, picture=True)
    assert "pair=" not in "".join(report)


async def test_no_qr_code_for_the_loopback_address(served: Served) -> None:
    assert not [line for line in lines(served, served.settings, picture=True) if "█" in line]


@pytest.mark.parametrize(
    ("host", "names", "called", "base"),
    [
        ("127.0.0.1", ["localhost", "127.0.0.1"], "", "http://localhost:8000"),
        ("127.0.0.1", ["localhost", "127.0.0.1"], "127.0.0.1", "http://127.0.0.1:8000"),
        ("127.0.0.1", ["localhost", "127.0.0.1"], "evil.example", "http://localhost:8000"),
        ("0.0.0.0", ["localhost", "turtle.local", "192.168.0.7"], "", "http://turtle.local:8000"),
        ("0.0.0.0", ["localhost", "turtle.local", "192.168.0.7"], "192.168.0.7", "http://192.168.0.7:8000"),
        ("0.0.0.0", ["localhost", "turtle.local"], "localhost", "http://turtle.local:8000"),
        ("0.0.0.0", ["localhost", "turtle.local"], "10.78.0.1", "http://10.78.0.1:8000"),
        ("0.0.0.0", ["localhost", "turtle.local"], "127.0.0.1", "http://turtle.local:8000"),
        ("::", ["localhost", "turtle.local"], "[fd00::7]", "http://[fd00::7]:8000"),
        ("::1", ["[::1]"], "", "http://[::1]:8000"),
        ("192.168.0.7", ["localhost", "192.168.0.7"], "localhost", "http://192.168.0.7:8000"),
    ],
)
def test_links_use_an_address_that_others_can_reach(
    settings: Settings, host: str, names: list[str], called: str, base: str
) -> None:
    chosen = settings.with_section(ServerConfig(host=host, allowed_hosts=names))
    assert chosen.base_url(called) == base
    assert chosen.only_here == (base.split("//")[1].rsplit(":", 1)[0] in ("localhost", "127.0.0.1", "[::1]"))
