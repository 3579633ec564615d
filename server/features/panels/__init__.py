"""Your own panels: small scripts in the data folder, which the page runs in a separate frame."""

from server.feature import Feature

FEATURE = Feature(
    name="panels",
    place="both",
    routes=("server.features.panels.routes:router",),
)
