"""A reverse proxy before the server: nginx as the manual configures it, and what clients say themselves."""

import asyncio
import re
import socket
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import replace
from ipaddress import ip_network
from pathlib import Path

import httpx
import pytest
from starlette.types import Message, Receive, Scope, Send
from websockets.asyncio.client import connect

from robot_runtime.clock import SimulatedClock
from server.http.connections import ADDRESS_MAX, Connections
from server.http.proxies import RequestsOfAddress
from server.http.sign_in.access import Access
from server.http.sign_in.welcome import welcome
from server.platform.audit_file import AuditEntry, read_entries
from server.platform.certificate import prepare_certificate, trust_only
from server.platform.reverse_proxy import read_proxies, read_public_url
from server.platform.server_config import ServerConfig
from server.platform.settings import Settings
from tests.server.ports import reserved_port
from tests.server.serving import Served, next_text, serve
from tests.server.sign_in.browsers import browser
from tests.server.waiting import SOCKET_LIMITS, until
from tests.waiting import SECONDS

MANUAL = Path(__file__).parents[3] / "docs/run/proxy.md"
NAME = "robots.lab"
CLIENT = "203.0.113.9"
TABLET = "127.0.0.2"
PAIRED = "Sign this browser in with a code"
PAGE = "<!doctype html><title>page</title>"


def write_configuration(folder: Path, settings: Settings, port: int) -> Path:
    """Return the manual's configuration with ports and files of the test's own."""
    match = re.search(r"```nginx\n(.*?)```", MANUAL.read_text(encoding="utf-8"), re.DOTALL)
    assert match is not None
    text = match[1]
    certificate = prepare_certificate(settings.with_section(ServerConfig(tls=True, allowed_hosts=[NAME])))
    for given, own in (
        ("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"),
        ("127.0.0.1:8000", f"127.0.0.1:{settings.server.port}"),
        ("/etc/ssl/robots.lab.pem", str(certificate.file)),
        ("/etc/ssl/robots.lab.key", str(certificate.key)),
    ):
        assert text.count(given) == 1
        text = text.replace(given, own)
    places = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    temporary = "\n".join(f"{path}_temp_path {folder}/{path};" for path in places)
    path = folder / "nginx.conf"
    path.write_text(
        f"daemon off; master_process off; pid {folder}/pid; error_log stderr;\nevents {{}}\n"
        f"http {{ access_log off; {temporary}\n{text} }}\n"
    )
    return path


@asynccontextmanager
async def nginx(served: Served, folder: Path, port: int) -> AsyncIterator[None]:
    path = write_configuration(folder, served.settings, port)
    process = await asyncio.create_subprocess_exec("/usr/sbin/nginx", "-c", str(path), "-e", "stderr")
    try:
        await until(lambda: process.returncode is not None or accepts(port), "nginx")
        assert process.returncode is None
        yield
    finally:
        process.terminate()
        await process.wait()


def accepts(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


async def audited(served: Served, action: str) -> AuditEntry:
    """Return the newest entry of an action, once it is there: the log has a thread of its own."""
    results: list[AuditEntry] = []

    def look() -> bool:
        entries = read_entries(served.settings.data.audit)
        results.extend(entry for entry in entries if entry.action == action)
        return bool(results)

    await until(look, action)
    return results[0]


@pytest.fixture
def port() -> Iterator[int]:
    with reserved_port() as number:
        yield number


async def test_behind_nginx_as_the_manual_has_it(settings: Settings, tmp_path: Path, port: int) -> None:
    origin = f"https://{NAME}:{port}"
    settings.page.mkdir()
    (settings.page / "index.html").write_text(PAGE)
    proxied = settings.with_section(ServerConfig(public_url=origin, trusted_proxies=["127.0.0.1"]))

    async with serve(proxied) as served, nginx(served, tmp_path, port):
        tls = trust_only(served.settings.data)
        made = (await served.api.post("/access/codes", json={"role": "operator"})).json()
        assert made["link"] == f"{origin}/#pair={made['code']}"
        headers = {"host": f"{NAME}:{port}", "origin": origin}
        base = f"https://127.0.0.1:{port}"
        transport = httpx.AsyncHTTPTransport(verify=tls, local_address=TABLET)
        async with httpx.AsyncClient(
            base_url=base, transport=transport, headers=headers, timeout=SECONDS
        ) as browser:
            assert (await browser.get("/")).text == PAGE
            body = {"code": made["code"], "name": "tablet"}
            # A client says that it is another; the proxy adds the true address behind it.
            paired = await browser.post("/api/access/pair", json=body, headers={"x-forwarded-for": CLIENT})
            assert paired.json()["identity"]["name"] == "tablet"
            assert "secure" in paired.headers["set-cookie"].lower()
            cookie = paired.headers["set-cookie"].partition(";")[0]
            secret = paired.json()["page_secret"]
            signed = {"cookie": cookie, "x-mucat": secret}
            upload = await browser.post("/api/imports", content=b"no archive" * 20_000, headers=signed)
            assert (upload.status_code, "archive" in upload.text) == (422, True)
            foreign = await browser.post(
                "/api/access/sign-out", headers=signed | {"origin": f"http://{NAME}:{port}"}
            )
            assert foreign.status_code == 403
            live = connect(
                f"wss://{NAME}:{port}/api/live",
                host="127.0.0.1",
                origin=origin,  # type: ignore[arg-type]
                ssl=tls,
                additional_headers={"cookie": cookie},
                subprotocols=["mucat", secret],  # type: ignore[list-item]
                max_size=None,
                **SOCKET_LIMITS,
            )
            async with live as page:
                assert (await next_text(page, "hello"))["you"]["name"] == "tablet"
                await page.send('{"op": "ping", "id": 7}')
                assert (await next_text(page, "pong"))["id"] == 7
        assert (await audited(served, PAIRED)).address == TABLET


@pytest.mark.parametrize(
    ("proxies", "forwarded", "seen"),
    [
        (["127.0.0.1"], CLIENT, CLIENT),
        (["127.0.0.1"], f"198.51.100.1, {CLIENT}", CLIENT),
        (["127.0.0.0/8"], f"198.51.100.1, {CLIENT}, 127.0.0.5", CLIENT),
        (["192.0.2.7"], CLIENT, "127.0.0.1"),
        ([], CLIENT, "127.0.0.1"),
    ],
)
async def test_the_client_is_the_last_address_that_a_trusted_proxy_names(
    settings: Settings, proxies: list[str], forwarded: str, seen: str
) -> None:
    async with serve(settings.with_section(ServerConfig(trusted_proxies=proxies))) as served:
        wrong = {"code": "AAAAA-AAAAA", "name": "x"}
        asked = await served.api.post("/access/pair", json=wrong, headers={"x-forwarded-for": forwarded})
        assert asked.status_code == 403
        assert (await audited(served, PAIRED)).address == seen


async def test_an_address_behind_a_proxy_has_a_limit_of_requests() -> None:
    release = asyncio.Event()
    statuses: list[int] = []

    async def app(_scope: Scope, _receive: Receive, _send: Send) -> None:
        await release.wait()
        statuses.append(200)

    async def send(message: Message) -> None:
        if message["type"] == "http.response.start":
            statuses.append(message["status"])

    async def receive() -> Message:
        raise AssertionError

    limited = RequestsOfAddress(app)

    async def ask(address: str) -> None:
        await limited({"type": "http", "client": (address, 0)}, receive, send)

    tasks = [asyncio.create_task(ask(CLIENT)) for _ in range(ADDRESS_MAX)]
    others = [asyncio.create_task(ask(address)) for address in ("198.51.100.1", CLIENT)]
    await asyncio.sleep(0)
    assert statuses == [429]
    release.set()
    await asyncio.gather(*others, *tasks)
    await ask(CLIENT)
    assert statuses == [429, *[200] * (ADDRESS_MAX + 2)]


class Idle:
    """A connection that does nothing."""

    waits = False
    progress = 0.0

    def overdue(self, _now: float) -> bool:
        return False

    def end(self) -> None:
        raise AssertionError


def test_the_connections_of_a_trusted_proxy_are_not_those_of_one_client() -> None:
    limits = Connections(SimulatedClock(), proxies=read_proxies(["127.0.0.0/30"]))
    assert all(limits.add(Idle(), TABLET) for _ in range(ADDRESS_MAX + 1))
    assert [limits.add(Idle(), CLIENT) for _ in range(ADDRESS_MAX + 1)] == [True] * ADDRESS_MAX + [False]


def test_connections_without_an_address_count_together_beside_a_trusted_proxy() -> None:
    limits = Connections(SimulatedClock(), proxies=read_proxies(["127.0.0.0/30"]))
    assert [limits.add(Idle(), "") for _ in range(ADDRESS_MAX + 1)] == [True] * ADDRESS_MAX + [False]


async def test_behind_a_proxy_a_link_is_printed_only_while_there_is_no_operator(served: Served) -> None:
    proxied = served.settings.with_section(replace(served.settings.server, public_url="https://robots.lab"))
    access = served.get(Access)
    report = "\n".join(welcome(proxied, access, None, picture=False))
    assert "others reach it by the proxy of https://robots.lab" in report
    assert "  https://robots.lab/#pair=" in report
    async with browser(served, "operator"):
        assert "#pair=" not in "\n".join(welcome(proxied, access, None, picture=False))


@pytest.mark.parametrize(
    ("text", "origin"),
    [
        ("", ""),
        ("https://Robots.lab/", "https://robots.lab"),
        ("https://robots.lab:443", "https://robots.lab"),
        ("http://robots.lab:8080", "http://robots.lab:8080"),
        ("https://[fd00::1]:9000", "https://[fd00::1]:9000"),
    ],
)
def test_a_public_url_is_an_origin(text: str, origin: str) -> None:
    assert read_public_url(text) == origin


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("https://robots.lab/turtle", "has a path"),
        ("https://robots.lab?x", "has a path"),
        ("robots.lab", "write it like"),
        ("ftp://robots.lab", "write it like"),
        ("https://me@robots.lab", "write it like"),
        ("https://robots.lab:x", "no address"),
    ],
)
def test_another_public_url_is_refused_in_words(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_public_url(text)


@pytest.mark.parametrize(
    ("name", "message"), [("nginx", "no address"), ("10.0.0.1/8", "no address"), ("0.0.0.0/0", "everybody")]
)
def test_proxies_are_addresses_or_networks(name: str, message: str) -> None:
    assert read_proxies(["127.0.0.1", "10.0.0.0/8"]) == (ip_network("127.0.0.1/32"), ip_network("10.0.0.0/8"))
    with pytest.raises(ValueError, match=message):
        read_proxies([name])
