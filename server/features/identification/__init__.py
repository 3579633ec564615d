"""Identification: fits the craft to recorded sessions, shows the result, adopts it."""

from server.feature import Feature

FEATURE = Feature(
    name="identification",
    optional=True,
    routes=("server.features.identification.routes:router",),
    commands={"identify": "server.features.identification.command:identify"},
    plug="server.features.identification.plug:IdentificationPlug",
)
