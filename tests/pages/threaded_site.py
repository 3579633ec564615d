"""A server with its page in a thread: Playwright keeps the event loop of its own running."""

import asyncio
import threading
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Self

from server.platform.settings import DataFolder
from tests.control import Commander
from tests.server.waiting import SECONDS
from tests.shell import ShellAuth


class ThreadedSite(ABC):
    """A server on a port of the system's choice; leaving the context ends it."""

    def __init__(self, data: Path) -> None:
        self.data = data
        self.port = 0
        self.api = Commander(timeout=SECONDS, auth=ShellAuth(DataFolder(data)))
        self._started = threading.Event()
        self._end = threading.Event()
        self._problem: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    @abstractmethod
    async def _serve(self) -> None:
        """Serve, say so by `port` and `_started`, until `_end`."""

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://127.0.0.1:{self.port}"

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
