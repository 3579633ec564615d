"""Saved layouts of panels."""

from server.feature import Feature

FEATURE = Feature(
    name="layouts",
    place="both",
    routes=("server.features.layouts.routes:router",),
)
