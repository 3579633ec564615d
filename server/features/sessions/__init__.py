"""The library of sessions: search, texts, bookmarks, replay and retention."""

from server.feature import Feature

FEATURE = Feature(
    name="sessions",
    place="both",
    section="server.library.config:SessionsConfig",
    routes=(
        "server.features.sessions.routes:router",
        "server.features.sessions.bookmark_routes:router",
        "server.features.sessions.film_routes:router",
    ),
    commands={
        "sessions": "server.features.sessions.command:sessions",
        "record": "server.features.sessions.command:record",
    },
    plug="server.features.sessions.plug:SessionsPlug",
)
