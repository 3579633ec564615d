"""Events for other programs: alarms, sessions, tests and missions, by MQTT and webhooks."""

from server.feature import Feature
from server.features.events.config import EventsConfig

FEATURE = Feature(
    name="events",
    section=EventsConfig,
    is_on=lambda events: bool(events.mqtt or events.webhook),
    plug="server.features.events.plug:EventsPlug",
)
