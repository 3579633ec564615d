"""The doctor: checks of the robot's computer, each with the command that solves its problem."""

from server.feature import Feature

FEATURE = Feature(
    name="doctor",
    place="both",
    routes=("server.features.doctor.routes:router",),
    commands={"doctor": "server.features.doctor.command:doctor"},
    plug="server.features.doctor.plug:DoctorPlug",
)
