"""The bring-up of a robot, from the page and the shell."""

from server.feature import Feature

FEATURE = Feature(
    name="bring_up",
    routes=("server.features.bring_up.routes:router",),
    commands={"bring-up": "server.features.bring_up.command:bring_up"},
    plug="server.features.bring_up.plug:BringUpPlug",
)
