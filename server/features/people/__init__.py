"""People and devices: pairing, roles, tokens."""

from server.feature import Feature

FEATURE = Feature(
    name="people",
    place="both",
    routes=(
        "server.features.people.routes:router",
        "server.features.people.reading_links:router",
        "server.features.people.audit:router",
    ),
    commands={
        "pair": "server.features.people.command:pair",
        "access": "server.features.people.command:access",
    },
)
