"""Membership in a lab: the robot joins by a code, says how it is, and answers the lab's STOP."""

from server.feature import Feature

FEATURE = Feature(
    name="membership",
    routes=("server.features.membership.routes:router",),
    commands={
        "lab join": "server.features.membership.command:join",
        "lab leave": "server.features.membership.command:leave",
    },
    plug="server.features.membership.plug:MembershipPlug",
)
