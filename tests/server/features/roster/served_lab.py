"""A lab's server in the test's event loop, with its router as a process."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import httpx

from robot_runtime.config import ZenohConfig
from server.app import create_app
from server.http.listener import open_socket
from server.http.serving import make_server
from server.platform.certificate import prepare_certificate, trust_only
from server.platform.settings import DataFolder, Settings, make_folders
from server.processes.supervisor import plan
from tests.server.new_database import place_empty
from tests.server.waiting import SECONDS, until
from tests.shell import ShellAuth


@dataclass
class RosterLab:
    """A running lab, and an HTTP client of it that has the shell's token."""

    api: httpx.AsyncClient
    settings: Settings

    async def code(self) -> dict[str, Any]:
        """Make a code for a robot."""
        made = (await self.api.post("/robots/codes")).raise_for_status()
        document: dict[str, Any] = made.json()
        return document

    async def robots(self) -> list[dict[str, Any]]:
        """Return the robots as the page gets them."""
        listed: list[dict[str, Any]] = (await self.api.get("/robots")).json()["robots"]
        return listed

    async def see(self, what: str, **values: object) -> dict[str, Any]:
        """Wait until the only robot has these values, and return it."""
        async with asyncio.timeout(SECONDS):
            while True:
                robots = await self.robots()
                if robots and values.items() <= (robots[0]["presence"] or {}).items():
                    return robots[0]
                await asyncio.sleep(0.02)
        raise AssertionError(what)


@asynccontextmanager
async def serve_lab(folder: Path, router_port: int, *, tls: bool = True) -> AsyncIterator[RosterLab]:
    """Run a lab on a port of the system's choice."""
    data = DataFolder(folder / "lab")
    make_folders(data)
    place_empty(data)
    settings = Settings(
        data=data,
        config=folder / "lab.toml",
        lab=True,
        zenoh=ZenohConfig(listen=[f"tls/127.0.0.1:{router_port}"]),
    )
    with open_socket("127.0.0.1", 0) as listener:
        port = listener.getsockname()[1]
        settings = settings.with_section(replace(settings.server, port=port, tls=tls))
        app = create_app(settings, plan(settings))
        certificate = prepare_certificate(settings) if tls else None
        server = make_server(app, certificate, settings.server.proxies)
        running = asyncio.create_task(server.serve(sockets=[listener]))
        try:
            await until(lambda: server.started or running.done(), "the lab to start")
            url, auth = f"{settings.scheme}://127.0.0.1:{port}/api", ShellAuth(data)
            verify = trust_only(data) if tls else False
            async with httpx.AsyncClient(base_url=url, timeout=SECONDS, auth=auth, verify=verify) as api:
                yield RosterLab(api, settings)
        finally:
            server.should_exit = True
            await running
