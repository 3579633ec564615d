"""A whole server on a loopback port, inside the test's own event loop.

The client of it has control, which lasts while it asks something every few seconds.
"""

import asyncio
import json
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import httpx
from websockets.asyncio.client import ClientConnection, connect

from robot_runtime.errors import RefusedError
from robot_runtime.transport.outbox import SIMULATOR_STREAM, STREAM
from server.app import create_app
from server.container import Container
from server.http.listener import open_socket
from server.http.serving import make_server
from server.platform.certificate import prepare_certificate, trust_only
from server.platform.schema import prepare
from server.platform.settings import Settings
from server.processes.managed_process import ProcessCommand
from server.stream.bridge import Bridge, RuntimeSilentError
from tests.server.new_database import place_with_samples
from tests.server.runtime_end import RuntimeEnd
from tests.server.waiting import SECONDS, SOCKET_LIMITS, until
from tests.shell import ShellAuth, shell_headers

T = TypeVar("T")


@dataclass
class Served:
    """A running server, an HTTP client of it that has the shell's token, and the runtime's end."""

    settings: Settings
    container: Container
    api: httpx.AsyncClient
    runtime: RuntimeEnd

    def get(self, kind: type[T]) -> T:
        """Return the server's service of this type."""
        return self.container.services.get(kind)

    def connect(self, **options: Any) -> connect:
        """Return a WebSocket to /api/live, with the shell's token and as from the server's own page."""
        own = f"{self.settings.scheme}://127.0.0.1:{self.settings.server.port}"
        token = shell_headers(self.settings.data)
        defaults: dict[str, Any] = {
            "origin": own,
            "max_size": None,
            "compression": None,
            **SOCKET_LIMITS,
            "additional_headers": token,
            "ssl": trust_only(self.settings.data) if self.settings.server.tls else None,
        }
        return connect(f"{own.replace('http', 'ws', 1)}/api/live", **(defaults | options))

    async def heard(self, topic: str) -> None:
        """Wait until the server listens to a topic."""
        await until(lambda: self.runtime.is_heard(topic), f"somebody to listen to {topic}")

    async def reached(self) -> None:
        """Wait until the runtime's end can be asked, and may be."""
        async with asyncio.timeout(SECONDS):
            while True:
                try:
                    await self.get(Bridge).command("there", {})
                    return
                except (RuntimeSilentError, RefusedError):
                    await asyncio.sleep(0.005)

    async def take_control(self) -> None:
        """Give the client control, from now on."""
        (await self.api.post("/control/take")).raise_for_status()


@asynccontextmanager
async def serve(settings: Settings, commands: Sequence[ProcessCommand] = ()) -> AsyncIterator[Served]:
    """Run the server of these settings at their host, on a port of the system's choice."""
    certificate = prepare_certificate(settings) if settings.server.tls else None
    with open_socket(settings.server.host, 0) as listener:
        settings = settings.with_section(replace(settings.server, port=listener.getsockname()[1]))
        await place_with_samples(settings.data)
        prepare(settings.data)
        app = create_app(settings, commands)
        server = make_server(app, certificate, settings.server.proxies)
        # The runtime listens before the server comes, which then need not try again.
        with RuntimeEnd(settings.data.runtime_socket, settings.robot.name) as runtime:
            running = asyncio.create_task(server.serve(sockets=[listener]))
            try:
                await until(lambda: server.started or running.done(), "the server to start")
                url = f"{settings.scheme}://127.0.0.1:{settings.server.port}/api"
                shell = ShellAuth(settings.data)
                verify = trust_only(settings.data) if settings.server.tls else False
                async with httpx.AsyncClient(base_url=url, timeout=SECONDS, auth=shell, verify=verify) as api:
                    served = Served(settings, app.state.container, api, runtime)
                    await served.heard(STREAM)
                    await served.heard(SIMULATOR_STREAM)
                    await served.reached()
                    await served.take_control()
                    yield served
            finally:
                server.should_exit = True
                await running
            assert not server.lifespan.should_exit, "the server failed to end; its log says why"


async def next_text(socket: ClientConnection, op: str) -> dict[str, Any]:
    """Return the next text message with this `op`; others are passed over."""
    async with asyncio.timeout(SECONDS):
        async for message in socket:
            if isinstance(message, str) and (answer := json.loads(message))["op"] == op:
                assert isinstance(answer, dict)
                return answer
    raise AssertionError(f"the socket was closed before {op} came")
