import asyncio
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from server.http.security import BODY_BYTES_MAX, SecurityMiddleware

HOSTS = ("localhost", "127.0.0.1", "[::1]", "turtle.local")
OWN = "http://localhost:8000"


def ask(
    kind: str = "http", method: str = "GET", *, port: int = 8000, at: str | None = None, **headers: Any
) -> int:
    """Return the status of a request with these headers that arrived `at` this address; 101 where a WebSocket
    is accepted."""
    sent: list[Message] = []

    async def inner(scope: Scope, _receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await send({"type": "websocket.accept"})
        else:
            await send({"type": "http.response.start", "status": 200, "headers": []})

    async def receive() -> Message:
        return {"type": "websocket.connect"}

    async def send(message: Message) -> None:
        sent.append(message)

    raw = [
        (name.replace("_", "-").encode(), value.encode())
        for name, values in headers.items()
        for value in ([values] if isinstance(values, str) else values)
    ]
    scope: dict[str, Any] = {
        "type": kind,
        "method": method,
        "path": "/api/x",
        "headers": raw,
        "server": at and (at, port),
        "scheme": "ws" if kind == "websocket" else "http",
    }
    asyncio.run(SecurityMiddleware(inner, HOSTS, port)(scope, receive, send))
    if kind == "websocket":
        return 101 if sent[0]["type"] == "websocket.accept" else 403
    status: int = sent[0]["status"]
    return status


@pytest.mark.parametrize("host", ["localhost:8000", "127.0.0.1:8000", "[::1]:8000", "TURTLE.local:8000"])
def test_own_hosts_are_accepted(host: str) -> None:
    assert ask(host=host) == 200
    assert ask(host=host, origin=f"http://{host.lower()}", method="POST") == 200
    assert ask("websocket", host=host, origin=f"http://{host}") == 101


@pytest.mark.parametrize(
    "host",
    [
        "evil.example:8000",
        "localhost",
        "localhost:8001",
        "localhost:8000.evil.example",
        "evil.localhost:8000",
        "localhost:8000@evil",
        "",
    ],
)
def test_foreign_hosts_are_refused(host: str) -> None:
    assert ask(host=host) == 403
    assert ask("websocket", host=host, origin=f"http://{host}") == 403


@pytest.mark.parametrize(
    ("host", "at"),
    [
        ("192.168.1.7:8000", "192.168.1.7"),
        ("192.168.1.7:8000", "::ffff:192.168.1.7"),
        ("[fd00::7]:8000", "fd00::7"),
        ("[FD00::7]:8000", "fd00::7"),
    ],
)
def test_the_address_at_which_a_request_arrives_is_the_server_s_own(host: str, at: str) -> None:
    assert ask(host=host) == 403
    assert ask(host=host, at=at) == 200
    assert ask("websocket", host=host, at=at, origin=f"http://{host}") == 101
    assert ask(host=host, at=at, origin="http://evil.example", method="POST") == 403


@pytest.mark.parametrize("host", ["192.168.1.8:8000", "192.168.1.7", "192.168.1.7:80", "evil.example:8000"])
def test_another_address_than_that_of_the_request_is_foreign(host: str) -> None:
    assert ask(host=host, at="192.168.1.7") == 403


def test_a_unix_socket_has_no_address_of_its_own() -> None:
    assert ask(host="/run/mucat:8000", at="/run/mucat") == 403


def test_exactly_one_host_header_is_accepted() -> None:
    assert ask() == 403
    assert ask(host=["localhost:8000", "localhost:8000"]) == 403
    assert ask(host=["localhost:8000", "evil.example:8000"]) == 403


def test_port_80_needs_no_port() -> None:
    assert ask(host="localhost", port=80) == 200
    assert ask(host="localhost:80", port=80) == 200


@pytest.mark.parametrize(
    "origin",
    [
        "null",
        "",
        "http://evil.example",
        "https://localhost:8000",
        "http://localhost",
        "http://localhost:8001",
        "http://127.0.0.1:8000",
        "http://localhost:8000.evil.example",
        "http://localhost:8000/",
        "ws://localhost:8000",
        "http://[",
        "http://[localhost:8000",
    ],
)
@pytest.mark.parametrize(("kind", "method"), [("http", "GET"), ("http", "POST"), ("websocket", "GET")])
def test_foreign_origins_are_refused(origin: str, kind: str, method: str) -> None:
    assert ask(kind, method, host="localhost:8000", origin=origin) == 403


def test_two_origins_are_refused() -> None:
    assert ask(host="localhost:8000", origin=[OWN, OWN]) == 403


@pytest.mark.parametrize(("kind", "method"), [("http", "PUT"), ("http", "DELETE"), ("websocket", "GET")])
@pytest.mark.parametrize("site", ["cross-site", "same-site", "none"])
def test_browsers_must_send_their_origin(kind: str, method: str, site: str) -> None:
    assert ask(kind, method, host="localhost:8000", sec_fetch_site=site) == 403


def test_programs_and_links_need_no_origin() -> None:
    assert ask(host="localhost:8000", method="POST") == 200
    assert ask("websocket", host="localhost:8000") == 101
    assert ask(host="localhost:8000", sec_fetch_site="cross-site") == 200


@pytest.mark.parametrize("header", ["x_forwarded_host", "x_forwarded_for", "forwarded", "x_real_ip"])
def test_proxy_headers_change_nothing(header: str) -> None:
    answer: dict[str, Any] = {header: "localhost:8000"}
    assert ask(host="evil.example:8000", **answer) == 403


def test_bodies_are_limited_and_have_a_length() -> None:
    assert ask(host="localhost:8000", method="POST", content_length=str(BODY_BYTES_MAX)) == 200
    assert ask(host="localhost:8000", method="POST", content_length=str(BODY_BYTES_MAX + 1)) == 413
    assert ask(host="localhost:8000", method="POST", transfer_encoding="chunked") == 413
