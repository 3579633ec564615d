"""Pages that take control and drive, over the live socket of a served application."""

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import httpx
from websockets.asyncio.client import ClientConnection

from server.driving.arbiter import ControlArbiter
from tests.server.serving import Served, next_text


class PageInControl:
    """A page: its socket, and requests with its key."""

    def __init__(self, served: Served, socket: ClientConnection, hello: dict[str, Any]) -> None:
        self.served = served
        self.socket = socket
        self.client: int = hello["you"]["client"]
        self.key: str = hello["client_key"]

    async def ask(self, path: str, body: Any = None) -> httpx.Response:
        headers = {"X-Mucat-Client": self.key}
        return await self.served.api.post(path, json=body, headers=headers)

    async def control_message(self, holder: int | None) -> dict[str, Any]:
        """Return the state of control as the server sends it, once this client has it."""
        while True:
            message = await next_text(self.socket, "control")
            if (message["holder"] or {"client": None})["client"] == holder:
                return message

    async def drive(self, **changes: Any) -> None:
        await self.socket.send(json.dumps(self.command(**changes)))

    def command(self, **changes: Any) -> dict[str, Any]:
        whole = {
            "op": "drive",
            "lease": self.served.get(ControlArbiter).lease.epoch,
            "sequence": 1,
            "taken": self.served.container.clock.now(),
            "axes": [0, 0, 1, 0, 0, 0],
        }
        return whole | changes


@asynccontextmanager
async def open_page(served: Served) -> AsyncIterator[PageInControl]:
    async with served.connect() as socket:
        yield PageInControl(served, socket, await next_text(socket, "hello"))


async def free(served: Served) -> None:
    (await served.api.post("/control/release")).raise_for_status()
