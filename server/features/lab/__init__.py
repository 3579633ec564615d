"""The lab: a server without a robot, which keeps the sessions of several."""

from server.feature import Feature

FEATURE = Feature(
    name="lab",
    section="server.platform.lab_config:LabConfig",
    place="lab",
    routes=("server.features.lab.routes:router",),
    commands={"lab": "server.features.lab.command:lab"},
    plug="server.features.lab.plug:LabPlug",
)
