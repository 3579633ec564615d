"""The plug of events for other programs."""

from robot_runtime.contract.topics import MISSION, STATE
from server.feature import Plug
from server.features.events.announcer import EventAnnouncer
from server.health.monitor import HealthMonitor
from server.stream.ends import RunEnds
from server.stream.feed import Feed
from server.stream.hub import Hub


class EventsPlug(Plug):
    """Announces what the pages are sent."""

    def __init__(
        self, announcer: EventAnnouncer, feed: Feed, hub: Hub, ends: RunEnds, monitor: HealthMonitor
    ) -> None:
        self._announcer = announcer
        feed.listen(announcer.see, STATE, MISSION)
        hub.listeners.append(announcer.see_message)
        ends.listeners.append(announcer.see_comm_test)
        monitor.outlets = announcer.condition

    async def open(self) -> None:
        """Connect."""
        self._announcer.open()

    async def close(self) -> None:
        """Send what waits."""
        await self._announcer.close()
