"""A lab that runs in the test's own event loop."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from typing import TypeVar

import httpx

from robot_runtime.config import ZenohConfig
from server.app import create_app
from server.container import Container
from server.http.listener import open_socket
from server.http.serving import make_server
from server.platform.schema import prepare
from server.platform.settings import Settings
from server.processes.supervisor import plan
from tests.server.ports import reserved_port
from tests.server.waiting import SECONDS, until
from tests.shell import ShellAuth

T = TypeVar("T")


@dataclass
class ServedLab:
    """A running lab, and an HTTP client of it that has the shell's token."""

    api: httpx.AsyncClient
    container: Container

    def get(self, kind: type[T]) -> T:
        """Return the lab's service of this type."""
        return self.container.services.get(kind)


@asynccontextmanager
async def serve_lab(settings: Settings, archive: str = "") -> AsyncIterator[ServedLab]:
    """Run a lab on a port of the system's choice, with its archive at this URL or in its folder."""
    settings.data.lab.write_text(archive)
    prepare(settings.data)
    with open_socket("127.0.0.1", 0) as listener, reserved_port() as router_port:
        port = listener.getsockname()[1]
        zenoh = ZenohConfig(listen=[f"tls/127.0.0.1:{router_port}"])
        settings = replace(settings, lab=True, zenoh=zenoh)
        settings = settings.with_section(replace(settings.server, port=port))
        app = create_app(settings, plan(settings))
        server = make_server(app, None, settings.server.proxies)
        running = asyncio.create_task(server.serve(sockets=[listener]))
        try:
            await until(lambda: server.started or running.done(), "the lab to start")
            url = f"http://127.0.0.1:{port}/api"
            async with httpx.AsyncClient(base_url=url, timeout=SECONDS, auth=ShellAuth(settings.data)) as api:
                yield ServedLab(api, app.state.container)
        finally:
            server.should_exit = True
            await running
