"""A whole server in a thread; in place of a robot, `bench.dive` sends it samples of one that floats."""

import asyncio
import threading
from math import inf
from pathlib import Path
from typing import Any, Self

from bench.dive import Dive
from robot_runtime.clock import Clock, SteadyClock
from server.features.doors.config import DoorsConfig
from server.http.sign_in.access import Access
from server.http.sign_in.confirmation import Confirmations
from server.platform.settings import DataFolder, Settings, make_folders
from tests.control import Commander
from tests.server.runtime_end import RuntimeEnd
from tests.server.serving import serve
from tests.server.waiting import SECONDS
from tests.shell import ShellToken
from tests.stack import ROOT

FLOAT_SECONDS = 1800.0
PERIOD = 0.1
"""s between two blocks of a topic."""


class DiveSite:
    """A server with its page, on a port of the system's choice; leaving the context ends it."""

    def __init__(self, data: Path, doors: DoorsConfig | None = None) -> None:
        self.data = data
        self._doors = doors or DoorsConfig()
        self.port = 0
        self._started = threading.Event()
        self._end = threading.Event()
        self._problem: BaseException | None = None
        self._runtime: RuntimeEnd | None = None
        self._access: Access | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.api = Commander(timeout=5.0, auth=ShellToken(DataFolder(data)))

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def first(self) -> str:
        """A page without charts and camera, which would take the browser twice the time to open."""
        return f"{self.url}/#/people"

    def forget_confirmations(self, clock: Clock) -> None:
        """Ask every browser for a new confirmation, whose age `clock` tells from now on."""
        assert self._access is not None
        self._access.confirmations = Confirmations(clock)

    @property
    def commands(self) -> list[tuple[str, dict[str, Any]]]:
        """All commands that have reached the robot's place."""
        assert self._runtime is not None
        return list(self._runtime.asked)

    def refuse(self, reason: str | None) -> None:
        """Has every command to the robot but STOP refused with this reason; None: accepted again."""
        assert self._runtime is not None
        self._runtime.refusal = reason

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._started.wait(SECONDS), "the server does not start"
        if self._problem is not None:
            raise self._problem
        self.api.base_url = f"{self.url}/api"
        return self

    def __exit__(self, *_: object) -> None:
        self.api.close()
        self._end.set()
        self._thread.join(SECONDS)
        assert not self._thread.is_alive(), "the server does not end"
        if self._problem is not None:
            raise self._problem

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as problem:
            self._problem = problem
            self._started.set()

    async def _serve(self) -> None:
        folder, clock = DataFolder(self.data), SteadyClock()
        make_folders(folder)
        settings = Settings(data=folder, config=ROOT / "robot.toml", sections={DoorsConfig: self._doors})
        async with serve(settings) as served:
            self._runtime = served.runtime
            self._access = served.get(Access)
            (await served.api.post("/control/release")).raise_for_status()
            self.port = served.settings.port
            dive = Dive(clock.now(), FLOAT_SECONDS, 1, armed_at=inf)
            self._started.set()
            while not self._end.is_set():
                served.runtime.publish(*dive.until(clock.now()))
                await asyncio.sleep(PERIOD)
