"""Scenarios: their library, and runs on the robot in real time or in simulated time."""

from server.feature import Feature

FEATURE = Feature(
    name="scenarios",
    place="both",
    routes=("server.features.scenarios.routes:router",),
    commands={"scenario": "server.features.scenarios.command:scenario"},
    plug="server.features.scenarios.plug:ScenariosPlug",
)
