"""Installation on a Raspberry Pi or any Debian: environments, services, updates, settings."""

from server.feature import Feature

FEATURE = Feature(
    name="installation",
    commands={
        "install": "server.features.installation.command:install",
        "update": "server.features.installation.command:update",
        "rollback": "server.features.installation.command:rollback",
        "uninstall": "server.features.installation.command:uninstall",
    },
    routes=("server.features.installation.routes:router",),
    plug="server.features.installation.plug:InstallationPlug",
)
