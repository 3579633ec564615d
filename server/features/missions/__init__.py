"""Missions: their library, trials in simulated time, and their start on the robot."""

from server.feature import Feature

FEATURE = Feature(
    name="missions",
    routes=("server.features.missions.routes:router", "server.features.missions.run_routes:router"),
    commands={"mission": "server.features.missions.command:mission"},
    plug="server.features.missions.plug:MissionsPlug",
)
