"""Sessions: recording, search, annotation, replay and retention."""

from server.feature import Feature
from server.features.sessions.config import SessionsConfig

FEATURE = Feature(
    name="sessions",
    section=SessionsConfig,
    routes=("server.features.sessions.routes:router",),
    commands={
        "sessions": "server.features.sessions.command:sessions",
        "record": "server.features.sessions.command:record",
    },
    plug="server.features.sessions.plug:SessionsPlug",
)
