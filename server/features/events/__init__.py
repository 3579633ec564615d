"""Events for other programs: alarms, sessions, tests and missions, by MQTT."""

from server.feature import Feature
from server.features.events.config import EventsConfig

FEATURE = Feature(
    name="events",
    section=EventsConfig,
    is_on=lambda events: bool(events.mqtt),
    removed=("webhook", "webhook_token_file"),
    plug="server.features.events.plug:EventsPlug",
)
