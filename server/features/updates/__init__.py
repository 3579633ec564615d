"""Updates of an installed robot that the page asks for."""

from server.feature import Feature

FEATURE = Feature(
    name="updates",
    routes=("server.features.updates.routes:router",),
    plug="server.features.updates.plug:UpdatesPlug",
)
