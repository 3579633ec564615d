"""Sweeps: a scenario with varied entries, run on this computer's cores or on a cluster."""

from server.feature import Feature

FEATURE = Feature(
    name="sweeps",
    section="server.features.sweeps.config:SweepsConfig",
    place="both",
    optional=True,
    routes=("server.features.sweeps.routes:router",),
    commands={
        "scenario sweep": "server.features.sweeps.command:sweep",
        "worker": "server.features.sweeps.worker_command:worker",
    },
    plug="server.features.sweeps.plug:SweepsPlug",
)
