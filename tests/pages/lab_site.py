"""A lab's server in a thread, with robots that only say how they are."""

import asyncio
import threading
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from server.interchange.presence import Presence
from server.platform.paired_robots import PairedRobot, PairedRobots
from server.platform.settings import DataFolder, Settings, make_folders
from tests.control import Commander
from tests.server.features.roster.lab_router import LabRouter, RobotEnd
from tests.server.features.roster.served_lab import serve_lab
from tests.server.waiting import SECONDS
from tests.shell import ShellAuth
from tests.stack import free_port

PERIOD = 0.2
"""s between two presences: a test need not wait for a second."""


class LabSite:
    """A lab with a robot for each of `present`, and others that are away; its page has no TLS."""

    def __init__(self, folder: Path, present: dict[str, Presence], absent: tuple[str, ...] = ()) -> None:
        self.data = folder / "lab"
        self.port = 0
        self.api = Commander(timeout=SECONDS, auth=ShellAuth(DataFolder(self.data)))
        self.ends: dict[str, RobotEnd] = {}
        self._folder = folder
        self._present = present
        self._names = (*present, *absent)
        self._started = threading.Event()
        self._end = threading.Event()
        self._problem: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def first(self) -> str:
        """The page of the robots."""
        return f"{self.url}/#/robots"

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._started.wait(SECONDS), "the lab does not start"
        if self._problem is not None:
            raise self._problem
        self.api.base_url = f"{self.url}/api"
        return self

    def __exit__(self, *_: object) -> None:
        self.api.close()
        self._end.set()
        self._thread.join(SECONDS)
        assert not self._thread.is_alive(), "the lab does not end"
        if self._problem is not None:
            raise self._problem

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as problem:
            self._problem = problem
            self._started.set()

    async def _serve(self) -> None:
        data, port = DataFolder(self.data), free_port()
        make_folders(data)
        router = LabRouter(Settings(data=data, config=self._folder), self._folder, port, *self._names)
        robots = PairedRobots(data)
        for name in self._names:
            robots.add(PairedRobot(name=name, address="", fingerprint="", token="none", joined=0.0))
        async with serve_lab(self._folder, port, tls=False) as lab:
            self.port = lab.settings.server.port
            with ExitStack() as stack:
                for name in self._present:
                    self.ends[name] = stack.enter_context(router.robot(name))
                self._started.set()
                while not self._end.is_set():
                    for name, presence in self._present.items():
                        self.ends[name].say(presence.model_dump_json())
                    await asyncio.sleep(PERIOD)
