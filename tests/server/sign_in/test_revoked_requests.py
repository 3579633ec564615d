"""Requests that are under way while the access of their sender is revoked."""

import asyncio
import json
from types import SimpleNamespace

import pytest
from starlette.types import Message, Receive, Scope, Send

from server.http.sign_in.middleware import SignInMiddleware
from server.platform.settings import Settings
from tests.server.serving import Served, serve
from tests.server.sign_in.browsers import Browser, browser
from tests.server.waiting import SECONDS


class HalfSent:
    """A request of a browser whose head has passed the sign-in, and whose body waits for its last byte."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, rest: bytes) -> None:
        self._reader = reader
        self._writer = writer
        self._rest = rest

    @classmethod
    async def begin(cls, visitor: Browser, served: Served, request: str, body: bytes) -> "HalfSent":
        port = served.settings.server.port
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        head = (
            f"{request} HTTP/1.1",
            *(f"Host: 127.0.0.1:{port}", f"Origin: {visitor.origin}", f"Cookie: {visitor.cookie}"),
            f"X-Mucat: {visitor.api.headers['x-mucat']}",
            *("Content-Type: application/json", f"Content-Length: {len(body)}"),
            *("Expect: 100-continue", "Connection: close", "", ""),
        )
        writer.write("\r\n".join(head).encode())
        # The server says this once it reads the body.
        async with asyncio.timeout(SECONDS):
            assert b" 100 " in await reader.readuntil(b"\r\n\r\n")
        writer.write(body[:-1])
        await writer.drain()
        return cls(reader, writer, body[-1:])

    async def end(self) -> tuple[int, str]:
        """Send the last byte; the answer's status and body."""
        self._writer.write(self._rest)
        async with asyncio.timeout(SECONDS):
            answer = (await self._reader.read()).decode()
        self._writer.close()
        return int(answer.split(" ", 2)[1]), answer.partition("\r\n\r\n")[2]


REQUESTS = {
    "POST /api/access/tokens": {"name": "later", "scope": "operate"},
    "POST /api/access/codes": {"role": "operator"},
    "POST /api/sessions": {"name": "Dive"},
    "PATCH /api/access/devices/2": {"role": "operator"},
    "POST /api/imports": {"no": "archive"},
}


@pytest.mark.parametrize(
    ("role", "status", "message"), [(None, 401, "revoked before"), ("viewer", 403, "you are a viewer")]
)
async def test_half_sent_requests_do_nothing_once_their_sender_may_not(
    role: str | None, status: int, message: str, served: Served
) -> None:
    async with (
        browser(served, "operator", "leaving") as leaving,
        browser(served, "viewer", "helper") as helper,
    ):
        halves = {
            line: await HalfSent.begin(leaving, served, line, json.dumps(body).encode())
            for line, body in REQUESTS.items()
        }
        if role is None:
            (await served.api.delete("/access/devices/1")).raise_for_status()
        else:
            (await served.api.patch("/access/devices/1", json={"role": role})).raise_for_status()
        for line, half in halves.items():
            answer = await half.end()
            assert answer[0] == status, line
            assert message in answer[1], line
        devices = (await served.api.get("/access/devices")).json()
        assert [device["name"] for device in devices if device["role"] == "operator"] == []
        assert not (await helper.api.get("/access/me")).json()["pairing_open"]
        assert (await helper.api.get("/sessions")).json() == []


async def test_a_revoked_browser_may_pair_again_in_a_request_that_began_before(served: Served) -> None:
    async with browser(served, "operator", "leaving") as leaving:
        made = await served.api.post("/access/codes", json={"role": "viewer"})
        body = json.dumps({"code": made.json()["code"], "name": "back"}).encode()
        half = await HalfSent.begin(leaving, served, "POST /api/access/pair", body)
        (await served.api.delete("/access/devices/1")).raise_for_status()
        status, text = await half.end()
        identity = {
            "device": 2,
            "name": "back",
            "role": "viewer",
            "kind": "browser",
            "limited": False,
            "session": None,
        }
        assert (status, json.loads(text)["identity"]) == (200, identity)


async def test_a_download_ends_with_the_access_of_its_receiver(settings: Settings) -> None:
    sent: list[Message] = []

    async with serve(settings) as served, browser(served, "viewer") as visitor:

        async def download(_: Scope, __: Receive, send: Send) -> None:
            await send({"type": "http.response.start", "status": 200, "headers": []})
            await send({"type": "http.response.body", "body": b"one", "more_body": True})
            (await served.api.delete("/access/devices/1")).raise_for_status()
            await send({"type": "http.response.body", "body": b"two", "more_body": True})
            await send({"type": "http.response.body", "body": b"three"})

        async def collect(message: Message) -> None:
            sent.append(message)

        async def nothing() -> Message:
            raise AssertionError("nobody reads the body")

        headers = [
            (b"cookie", visitor.cookie.encode()),
            (b"x-mucat", visitor.api.headers["x-mucat"].encode()),
        ]
        state = SimpleNamespace(services=served.container.services)
        scope = {"type": "http", "method": "GET", "path": "/api/backup", "headers": headers}
        await SignInMiddleware(download)(scope | {"app": SimpleNamespace(state=state)}, nothing, collect)
    assert [message.get("body") for message in sent] == [None, b"one"]
