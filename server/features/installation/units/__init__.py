"""The services of an installed robot or lab, and the command `mucat` of its shell."""

from importlib.resources import files

from server.features.installation.places import USER, InstallPlaces

FOLDER = files(__name__)
"""An installation runs from wheels that are not unpacked."""
RECOVER = "mucat-recover.service"
UPDATE = ("mucat-update.path", "mucat-update.service")
"""The services of updates from the page, which a lab's page does not offer.

All are files beside this one, with `{data}`, `{current}` and others for the places of the installation."""

JOURNAL = """# By mucat install: what all services say stays within 100 MB of the card.
[Journal]
SystemMaxUse=100M
"""


def write_units(places: InstallPlaces) -> dict[str, str]:
    """Return the text of each unit, by its name."""
    values = {
        name: getattr(places, name)
        for name in ("data", "config", "current", "previous", "request", "journal")
    }
    common = (FOLDER / "service").read_text(encoding="utf-8").format(**values, user=USER)
    return {
        name: (FOLDER / name).read_text(encoding="utf-8").format(**values, common=common.strip())
        for name in (*places.services, RECOVER, *(() if places.lab else UPDATE))
    }


def write_command(places: InstallPlaces) -> str:
    """Return the shell's command `mucat`: with the robot's data and configuration, as the service's user."""
    program = places.current / "bin/mucat"
    return f"""#!/bin/sh
# µ-CAT as installed on this computer. Its data belong to the user {USER}, so that root becomes that user for
# everything but what changes the installation itself.
MUCAT_DATA={places.data} MUCAT_CONFIG={places.config}
export MUCAT_DATA MUCAT_CONFIG
case "${{1-}}" in
    install | uninstall | update | rollback) exec {program} "$@" ;;
esac
test "$(id -u)" -ne 0 || exec runuser -u {USER} -- {program} "$@"
exec {program} "$@"
"""
