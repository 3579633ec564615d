"""Export of sessions to files of several formats, and import of archives."""

from server.feature import Feature

FEATURE = Feature(
    name="exports",
    place="both",
    routes=("server.features.exports.routes:router",),
    commands={
        "export": "server.features.exports.command:export_session",
        "import": "server.features.exports.command:import_session",
        "lab lake": "server.features.exports.lake_command:lake",
    },
    plug="server.features.exports.plug:ExportsPlug",
)
