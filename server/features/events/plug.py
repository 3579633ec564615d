"""The plug of events for other programs."""

import asyncio
from typing import ClassVar

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import MISSION, STATE
from server.feature import Plug
from server.features.events.announcer import EventAnnouncer
from server.features.events.config import EventsConfig
from server.features.events.mqtt import MqttOutlet
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings
from server.services import Maker
from server.stream.ends import RunEnds
from server.stream.feed import Feed
from server.stream.hub import Hub


def make_outlet(settings: Settings) -> MqttOutlet:
    """Return the broker."""
    return MqttOutlet(settings.robot.name, settings.section(EventsConfig), settings.config.parent)


def make_announcer(settings: Settings, clock: Clock, outlet: MqttOutlet) -> EventAnnouncer:
    """Return the announcer to the broker."""
    return EventAnnouncer(settings.robot.name, clock, outlet)


class EventsPlug(Plug):
    """The plug that announces the pages' messages as events."""

    makers: ClassVar[tuple[Maker, ...]] = (make_outlet, make_announcer)

    def __init__(
        self,
        announcer: EventAnnouncer,
        outlet: MqttOutlet,
        feed: Feed,
        hub: Hub,
        ends: RunEnds,
        monitor: HealthMonitor,
    ) -> None:
        self._outlet = outlet
        feed.listen(announcer.see, STATE, MISSION)
        hub.listeners.append(announcer.see_message)
        ends.listeners.append(announcer.see_comm_test)
        monitor.more["events"] = outlet.condition

    async def open(self) -> None:
        """Connect."""
        self._outlet.open()

    async def close(self) -> None:
        """Send waiting messages, for a short time, and end."""
        await asyncio.to_thread(self._outlet.close)
