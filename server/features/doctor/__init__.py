"""The doctor: checks of the computer that the robot runs on, each with the command that mends it."""

from server.feature import Feature

FEATURE = Feature(
    name="doctor",
    routes=("server.features.doctor.routes:router",),
    commands={"doctor": "server.features.doctor.command:doctor"},
    plug="server.features.doctor.plug:DoctorPlug",
)
