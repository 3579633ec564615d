"""Recording: sessions that people, arming and scenarios begin and end."""

from server.feature import Feature

FEATURE = Feature(
    name="recording",
    routes=("server.features.recording.routes:router",),
    plug="server.features.recording.plug:RecordingPlug",
)
