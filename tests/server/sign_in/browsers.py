"""Browsers as the server sees them: a cookie, the page's secret and its origin."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Any

import httpx
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from server.http.sign_in.identity import Role
from tests.server.serving import Served
from tests.server.waiting import SECONDS


class Browser:
    """A browser that is not signed in yet."""

    def __init__(self, served: Served, name: str) -> None:
        self.name = name
        self._served = served
        self.origin = f"http://127.0.0.1:{served.settings.server.port}"
        headers = {"origin": self.origin}
        self.api = httpx.AsyncClient(base_url=f"{self.origin}/api", headers=headers, timeout=SECONDS)

    async def pair(self, code: str) -> httpx.Response:
        answer = await self.api.post("/access/pair", json={"code": code, "name": self.name})
        if answer.is_success and (secret := answer.json()["page_secret"]) is not None:
            self.api.headers["x-mucat"] = secret
        return answer

    async def device(self) -> int:
        number: int = (await self.api.get("/access/me")).json()["identity"]["device"]
        return number

    @property
    def cookie(self) -> str:
        return "; ".join(f"{name}={value}" for name, value in self.api.cookies.items())

    def connect(self, **options: Any) -> connect:
        """Open the browser's live socket."""
        secret = self.api.headers.get("x-mucat")
        shown = {} if secret is None else {"subprotocols": ["mucat", secret]}
        return self._served.connect(additional_headers={"cookie": self.cookie}, **(shown | options))


@asynccontextmanager
async def browser(served: Served, role: Role | None, name: str = "tablet") -> AsyncIterator[Browser]:
    """A browser, paired in this role by the shell; None: not paired."""
    visitor = Browser(served, name)
    async with visitor.api:
        if role is not None:
            (await visitor.pair(await new_code(served, role))).raise_for_status()
        yield visitor


async def new_code(served: Served, role: Role) -> str:
    answer = await served.api.post("/access/codes", json={"role": role})
    code: str = answer.raise_for_status().json()["code"]
    return code


async def closing_of(socket: ClientConnection) -> tuple[int, str]:
    """Code and reason with which the server closes a socket."""
    async with asyncio.timeout(SECONDS):
        with suppress(ConnectionClosed):
            async for _ in socket:
                pass
    assert socket.close_code is not None
    return socket.close_code, socket.close_reason or ""
