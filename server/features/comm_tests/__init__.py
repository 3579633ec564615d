"""Runs of the communication test: storage, lists, comparison and export."""

from server.feature import Feature

FEATURE = Feature(
    name="comm_tests",
    routes=("server.features.comm_tests.routes:router",),
    commands={"commtest": "server.features.comm_tests.command:commtest"},
    plug="server.features.comm_tests.plug:CommTestPlug",
)
