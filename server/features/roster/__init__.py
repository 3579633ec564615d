"""The robots of a lab: they join by a code, say how they are, and are stopped all at once."""

from server.feature import Feature

FEATURE = Feature(
    name="roster",
    place="lab",
    routes=("server.features.roster.routes:router",),
    commands={
        "lab pair": "server.features.roster.command:pair",
        "lab robots": "server.features.roster.command:robots",
        "lab stop": "server.features.roster.command:stop",
        "lab remove": "server.features.roster.command:remove",
    },
    plug="server.features.roster.plug:RosterPlug",
)
