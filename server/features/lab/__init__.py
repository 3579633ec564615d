"""The lab: a server without a robot, which keeps the sessions of several."""

from server.feature import Feature
from server.platform.lab_config import LabConfig

FEATURE = Feature(
    name="lab",
    section=LabConfig,
    place="lab",
    routes=("server.features.lab.routes:router",),
    commands={"lab": "server.features.lab.command:lab"},
    plug="server.features.lab.plug:LabPlug",
)
