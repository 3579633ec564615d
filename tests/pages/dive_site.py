"""A whole server in a thread; in place of a robot, a synthetic dive sends it samples as fast as a robot."""

import asyncio
import threading
from pathlib import Path
from typing import Any, Self

from bench.dive import Dive
from robot_runtime.clock import SteadyClock
from robot_runtime.config import SessionsConfig
from server.platform.settings import DataFolder, Settings, make_folders
from tests.control import Commander
from tests.server.runtime_end import RuntimeEnd
from tests.server.serving import serve
from tests.server.waiting import SECONDS
from tests.shell import ShellToken
from tests.stack import ROOT

DIVE_SECONDS = 1800.0
PERIOD = 0.1
"""s between two blocks of a topic."""


class DiveSite:
    """A server with its page, on a port of the system's choice; leaving the context ends it."""

    def __init__(self, data: Path) -> None:
        self.data = data
        self.port = 0
        self._started = threading.Event()
        self._end = threading.Event()
        self._problem: BaseException | None = None
        self._runtime: RuntimeEnd | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.api = Commander(timeout=5.0, auth=ShellToken(DataFolder(data)))

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def commands(self) -> list[tuple[str, dict[str, Any]]]:
        """All commands that have reached the robot's place."""
        assert self._runtime is not None
        return list(self._runtime.asked)

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
        # The dive arms by itself, and the tests record what they need.
        settings = Settings(
            data=folder, config=ROOT / "robot.toml", sessions=SessionsConfig(record_at_arming=False)
        )
        async with serve(settings) as served:
            self._runtime = served.runtime
            (await served.api.post("/control/release")).raise_for_status()
            self.port = served.settings.port
            dive = Dive(clock.now(), DIVE_SECONDS, 1)
            self._started.set()
            while not self._end.is_set():
                served.runtime.publish(*dive.until(clock.now()))
                await asyncio.sleep(PERIOD)
