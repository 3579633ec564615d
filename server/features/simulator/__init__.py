"""The simulator of a robot with hardware in the loop: on this computer or another one."""

from server.feature import Feature

FEATURE = Feature(
    name="simulator",
    routes=("server.features.simulator.routes:router",),
    commands={
        "simulator": "server.features.simulator.command:simulator",
    },
)
