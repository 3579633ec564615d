"""Snapshots: pictures of the camera at full size, taken by a person into the recorded session."""

from server.feature import Feature

FEATURE = Feature(
    name="snapshots",
    routes=("server.features.snapshots.routes:router",),
    plug="server.features.snapshots.plug:SnapshotsPlug",
)
