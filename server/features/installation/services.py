"""`python -I -m server.features.installation.services`: writes this version's services, for an update."""

import os
import sys

from server.features.installation.effects import Effects
from server.features.installation.installer import Installer
from server.features.installation.places import InstallPlaces
from server.platform.settings import SetupError
from server.platform.terminal import echo


def main() -> None:
    """Write the services. Exit with status 1 and the reason where that fails."""
    os.umask(0o022)
    try:
        Installer(InstallPlaces(), Effects(echo), lambda _: False).write_services()
    except SetupError as problem:
        sys.exit(str(problem))


if __name__ == "__main__":
    main()
