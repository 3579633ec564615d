"""Events for other programs: alarms, sessions, tests and missions, by MQTT."""

from server.feature import Feature

FEATURE = Feature(
    name="events",
    section="server.features.events.config:EventsConfig",
    is_on=lambda events: bool(events.mqtt),
    removed=("webhook", "webhook_token_file"),
    plug="server.features.events.plug:EventsPlug",
)
