"""The lab's router, kept running in a process of its own."""

import asyncio
import logging
import re
from signal import SIGTERM

from server.health.monitor import Condition
from server.platform.settings import Settings
from server.processes.side_process import SideProcess

log = logging.getLogger(__name__)

PORT = 7447
"""The port of Zenoh."""
AGAIN_SECONDS = 1.0
STARTING = "The router is starting."


class RouterProcess:
    """The router. It reads at its start who is let in: a change starts it anew, and the robots come back."""

    def __init__(self, settings: Settings) -> None:
        self.problem = STARTING
        """Reason why no robot can be heard; empty while the router runs."""
        host = settings.server.host
        self._network = settings.zenoh.listen or [f"tls/{f'[{host}]' if ':' in host else host}:{PORT}"]
        self._folder = settings.data
        self._process: SideProcess | None = None
        self._runs = asyncio.Event()
        self._meant = False

    @property
    def port(self) -> int:
        """The port on which robots reach it."""
        port = re.search(r":([0-9]+)$", self._network[0])
        return int(port[1]) if port else PORT

    async def run(self) -> None:
        """Keep it running, for ever."""
        endpoints = [f"unixsock-stream/{self._folder.router_socket}", *self._network]
        arguments = ["--certificates", str(self._folder.zenoh)]
        arguments += [word for endpoint in endpoints for word in ("--listen", endpoint)]
        while True:
            self._folder.router_socket.unlink(missing_ok=True)
            with SideProcess("server.features.roster.router", arguments) as self._process:
                async for _ in self._process.documents():
                    self.problem = ""
                    self._runs.set()
                self._runs.clear()
                self.problem = f"The router {await self._process.describe_end()}"
            self._process = None
            if self._meant:
                self._meant = False
                continue
            log.warning("%s It is started again.", self.problem)
            await asyncio.sleep(AGAIN_SECONDS)

    def condition(self) -> Condition:
        """Return its condition, for the health of the lab."""
        if not self.problem:
            return "ok", f"Robots reach it at port {self.port}."
        return "starting" if self.problem == STARTING else "failed", self.problem

    async def wait(self) -> None:
        """Wait until it runs."""
        await self._runs.wait()

    def renew(self) -> None:
        """Restart it, so that it reads who is let in; a robot that was removed loses its connection."""
        if self._process is not None:
            self._meant = True
            self._process.signal(SIGTERM)
