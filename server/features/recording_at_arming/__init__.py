"""Recording at arming: a session begins when the robot is armed, and ends after it was disarmed."""

from server.feature import Feature

FEATURE = Feature(
    name="recording_at_arming",
    plug="server.features.recording_at_arming.plug:ArmingPlug",
)
