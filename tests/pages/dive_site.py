"""A whole server in a thread; in place of a robot, `bench.dive` sends it samples of one that floats."""

import asyncio
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from math import inf
from pathlib import Path
from typing import Any

from bench.dive import Dive
from robot_runtime.clock import Clock, SteadyClock
from robot_runtime.transport.blocks import Block
from server.features.doors.config import DoorsConfig
from server.http.sign_in.access import Access
from server.http.sign_in.confirmation import Confirmations
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from tests.pages.threaded_site import ThreadedSite
from tests.server.blocks import snapshot_block
from tests.server.new_database import new_store
from tests.server.runtime_end import RuntimeEnd
from tests.server.serving import serve
from tests.stack import ROOT

FLOAT_SECONDS = 1800.0
PERIOD = 0.25
"""s between two blocks of a topic."""


@contextmanager
def recorded_site(data: Path, record_all: Callable[[Store, Settings], object]) -> Iterator["DiveSite"]:
    """A site whose sessions are those that `record_all` stores."""
    settings = Settings(data=DataFolder(data), config=ROOT / "robot.toml")
    make_folders(settings.data)

    def prepare() -> None:
        with new_store(settings.data) as store:
            record_all(store, settings)

    with ThreadPoolExecutor(1) as elsewhere:  # Playwright keeps an event loop running here
        elsewhere.submit(prepare).result()
    with DiveSite(data) as site:
        yield site


class DiveSite(ThreadedSite):
    """A whole server with its page.

    Blocks are `period` s apart; `more` gives further ones that are due now (s, steady clock).
    """

    def __init__(
        self,
        data: Path,
        doors: DoorsConfig | None = None,
        *,
        period: float = PERIOD,
        more: Callable[[float], Iterable[Block]] = lambda _: (),
    ) -> None:
        super().__init__(data)
        self._period, self._more = period, more
        self._doors = doors or DoorsConfig()
        self._runtime: RuntimeEnd | None = None
        self._access: Access | None = None

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

    @property
    def driven(self) -> list[dict[str, Any]]:
        """The driver's messages in the order in which they came."""
        assert self._runtime is not None
        return list(self._runtime.driven)

    def refuse(self, reason: str | None) -> None:
        """Have every command to the robot but STOP refused with this reason; None: accepted again."""
        assert self._runtime is not None
        self._runtime.refusal = reason

    def show(self, jpeg: bytes) -> None:
        """Make this picture the next snapshot, taken now."""
        assert self._runtime is not None
        before = self._runtime.snapshot
        number = 0 if before is None else before.following
        self._runtime.snapshot = snapshot_block(number, SteadyClock().now(), jpeg)

    async def _serve(self) -> None:
        folder, clock = DataFolder(self.data), SteadyClock()
        make_folders(folder)
        settings = Settings(data=folder, config=ROOT / "robot.toml", sections={DoorsConfig: self._doors})
        async with serve(settings) as served:
            self._runtime = served.runtime
            self._access = served.get(Access)
            (await served.api.post("/control/release")).raise_for_status()
            self.port = served.settings.server.port
            dive = Dive(clock.now(), FLOAT_SECONDS, 1, armed_at=inf)
            self._started.set()
            while not self._end.is_set():
                now = clock.now()
                served.runtime.publish(*dive.until(now), *self._more(now))
                await asyncio.sleep(self._period)
