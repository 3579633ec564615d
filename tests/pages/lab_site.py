"""A lab's server in a thread, with robots that only say how they are."""

import asyncio
from contextlib import ExitStack
from pathlib import Path

from server.interchange.presence import Presence, PresentAlarm, PresentMission
from server.platform.paired_robots import PairedRobot, PairedRobots
from server.platform.settings import DataFolder, Settings, make_folders
from tests.pages.threaded_site import ThreadedSite
from tests.server.features.roster.lab_router import LabRouter, RobotEnd
from tests.server.features.roster.served_lab import serve_lab
from tests.stack import free_port

PERIOD = 0.2
"""s between two presences: a test need not wait for a second."""


def presence(**values: object) -> Presence:
    """Return a presence of a robot at rest, with these values."""
    at_rest: dict[str, object] = {
        "mode": "disarmed",
        "armed": False,
        "connected": True,
        "depth": 0.02,
        "battery": 7.9,
        "battery_left": None,
        "mission": None,
        "recording": None,
        "disk_free": 20_000_000_000,
        "disk_total": 32_000_000_000,
        "alarms": [],
        "software": "1.0",
        "address": "",
        "fingerprint": "",
    }
    return Presence.model_validate(at_rest | values)


SWIMMING = presence(
    mode="automatic",
    armed=True,
    depth=1.234,
    battery=7.4,
    battery_left=1500.0,
    mission=PresentMission(title="Survey of the pool", phase="running", progress=0.42),
    recording="2026-11-24 dive",
    alarms=[PresentAlarm(severity="caution", what="The battery is low.")],
    address="https://turtle-1.local:8000",
)


class LabSite(ThreadedSite):
    """A lab with a robot for each of `present`, and others that are away; its page has no TLS."""

    def __init__(self, folder: Path, present: dict[str, Presence], absent: tuple[str, ...] = ()) -> None:
        super().__init__(folder / "lab")
        self.ends: dict[str, RobotEnd] = {}
        self._folder = folder
        self._present = present
        self._names = (*present, *absent)

    @property
    def first(self) -> str:
        """The page of the robots."""
        return f"{self.url}/#/robots"

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
