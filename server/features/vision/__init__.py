"""The vision node's settings, in the interface and in robot.toml."""

from server.feature import Feature

FEATURE = Feature(
    name="vision",
    routes=("server.features.vision.routes:router",),
)
