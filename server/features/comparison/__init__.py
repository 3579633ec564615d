"""Comparison of sessions: signals on one time axis, figures, differences."""

from server.feature import Feature

FEATURE = Feature(
    name="comparison",
    place="both",
    routes=(
        "server.features.comparison.routes:router",
        "server.features.comparison.story_routes:router",
        "server.features.comparison.study_routes:router",
        "server.features.comparison.figure_routes:router",
    ),
    commands={"report": "server.features.comparison.command:report"},
    plug="server.features.comparison.plug:ComparisonPlug",
)
