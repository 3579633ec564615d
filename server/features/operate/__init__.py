"""Operating the robot: commands, the scene's view, the frames of the serial line."""

from server.feature import Feature

FEATURE = Feature(
    name="operate",
    routes=("server.features.operate.routes:router",),
)
