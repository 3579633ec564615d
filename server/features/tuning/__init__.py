"""Tuning: step responses and relay experiments on the running robot, and their results."""

from server.feature import Feature

FEATURE = Feature(
    name="tuning",
    routes=("server.features.tuning.routes:router",),
    plug="server.features.tuning.plug:TuningPlug",
)
