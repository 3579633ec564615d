"""Backup and restore of the database."""

from server.feature import Feature

FEATURE = Feature(
    name="backup",
    place="both",
    routes=("server.features.backup.routes:router",),
    commands={
        "backup": "server.features.backup.command:backup",
        "restore": "server.features.backup.command:restore",
    },
    plug="server.features.backup.plug:BackupPlug",
)
