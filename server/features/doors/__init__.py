"""Doors for other programs: rosbridge and the Foxglove WebSocket, behind the sign-in of the page."""

from server.feature import Feature

FEATURE = Feature(
    name="doors",
    section="server.features.doors.config:DoorsConfig",
    is_on=lambda doors: doors.rosbridge or doors.foxglove or doors.ros2,
    routes=(
        "server.features.doors.routes:router",
        "server.features.doors.routes:open_routes",
    ),
    commands={"certificate": "server.features.doors.certificates:certificate"},
    plug="server.features.doors.plug:DoorsPlug",
    prepare="server.features.doors.ros2_certificates:prepare_ros2",
)
