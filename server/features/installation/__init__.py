"""Installation on a Raspberry Pi or any Debian: environments, services, and settings of the computer."""

from server.feature import Feature

FEATURE = Feature(
    name="installation",
    commands={
        "install": "server.features.installation.command:install",
        "update": "server.features.installation.command:update",
        "rollback": "server.features.installation.command:rollback",
        "uninstall": "server.features.installation.command:uninstall",
    },
)
