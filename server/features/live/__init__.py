"""The live socket of a page: samples and news to it, driving and STOP from it."""

from server.feature import Feature

FEATURE = Feature(
    name="live",
    place="both",
    routes=(
        "server.features.live.routes:router",
        "server.features.live.past_routes:router",
        "server.features.live.topic_routes:router",
    ),
)
