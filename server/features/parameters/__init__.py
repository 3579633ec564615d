"""Parameters: their changes, undo, and saved profiles."""

from server.feature import Feature

FEATURE = Feature(
    name="parameters",
    routes=("server.features.parameters.routes:router",),
)
