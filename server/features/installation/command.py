"""`mucat install`, `update`, `rollback` and `uninstall`: on a Raspberry Pi or any Debian, as root."""

import os
import socket
from contextlib import nullcontext, suppress
from pathlib import Path

import click

from server.features.installation.effects import CommandFailedError, Effects
from server.features.installation.environments import WHEELS
from server.features.installation.installer import Installer
from server.features.installation.places import InstallPlaces
from server.features.installation.release import SIGNATURE, check_signature, read_release
from server.features.installation.report import hold
from server.features.installation.updater import Updater
from server.platform.command_line import FILE, CommandError
from server.platform.last_configuration import read_usable_settings
from server.platform.settings import SetupError
from server.platform.terminal import echo

OPEN_UMASK = 0o022
"""Programs and settings may be read by everybody; what is private says so itself."""


@click.command()
@click.argument("release", type=FILE, required=False)
@click.option("--yes", is_flag=True, help="Change the boot settings without asking.")
@click.option("--dry-run", is_flag=True, help="Say what would be done, and do nothing.")
@click.option("--lab", is_flag=True, help="Install a lab: a server without a robot, for several robots.")
def install(release: Path | None, *, yes: bool, dry_run: bool, lab: bool) -> None:
    """Install µ-CAT as services on this computer.

    RELEASE is a folder of wheels; the default is that of the installed version. Existing files stay; a
    repeated installation adds missing ones.
    """
    places = InstallPlaces(lab=lab)
    _require_root("install", dry=dry_run)
    os.umask(OPEN_UMASK)
    effects = Effects(echo, dry=dry_run)
    installer = Installer(places, effects, lambda question: yes or click.confirm(question, default=False))
    try:
        loaded = read_release((release or places.current / WHEELS).absolute())
        if (loaded.folder / SIGNATURE).exists():
            own = loaded.folder / "release.pem"
            check_signature(loaded, places.key if places.key.exists() or not own.exists() else own)
        with nullcontext() if dry_run else hold(places.lock):
            installer.install(loaded)
    except SetupError as problem:
        raise CommandError(str(problem)) from problem
    if not dry_run:
        _greet(places, effects)


@click.command()
@click.argument("release", type=FILE, required=False)
@click.option("--asked-by-page", is_flag=True, hidden=True, help="Take the release that the page has sent.")
def update(release: Path | None, *, asked_by_page: bool) -> None:
    """Update µ-CAT as installed on this computer, or leave it as it is.

    RELEASE is a folder or ZIP file, signed with the key that the installation knows. It is refused while the
    robot is armed or a session is recorded. A version that is not healthy within a minute is taken back.
    """
    _require_root("update", dry=False)
    os.umask(OPEN_UMASK)
    places, effects = InstallPlaces(), Effects(echo)
    if release is None and not asked_by_page:
        raise click.UsageError("Name the release: a folder or a ZIP file.")
    try:
        version = (
            Updater(places, effects).update(release.absolute())
            if release
            else _update_for_page(places, effects)
        )
    except SetupError as problem:
        raise CommandError(str(problem)) from problem
    echo(f"µ-CAT {version} is in use. sudo mucat rollback goes back.")


@click.command()
@click.option("--cut-off", is_flag=True, hidden=True, help="Go back from an update that a power cut ended.")
def rollback(*, cut_off: bool) -> None:
    """Go back to the version before the last update.

    A database that the older version cannot read is replaced by its copy from before the update; the present
    one is put aside.
    """
    _require_root("rollback", dry=False)
    os.umask(OPEN_UMASK)
    updater = Updater(InstallPlaces(), Effects(echo))
    try:
        if cut_off:
            updater.recover(starting=True)
        else:
            echo(f"µ-CAT {updater.roll_back()} is in use.")
    except SetupError as problem:
        raise CommandError(str(problem)) from problem


@click.command()
@click.option("--dry-run", is_flag=True, help="Say what would be done, and do nothing.")
def uninstall(*, dry_run: bool) -> None:
    """Remove the services and the software; the data stay.

    It is refused while the robot is armed or a session is recorded.
    """
    places = InstallPlaces()
    _require_root("uninstall", dry=dry_run)
    installer = Installer(places, Effects(echo, dry=dry_run), lambda _: False)
    try:
        with nullcontext() if dry_run else hold(places.lock):
            installer.uninstall()
    except SetupError as problem:
        raise CommandError(str(problem)) from problem
    echo(f"{places.data} and {places.settings} stay. The boot settings before are in *.before-mucat beside.")


def _require_root(command: str, *, dry: bool) -> None:
    if not dry and os.geteuid() != 0:
        raise CommandError(f"This changes the computer: sudo mucat {command}. With --dry-run it says how.")


def _update_for_page(places: InstallPlaces, effects: Effects) -> str:
    """Update to the release that the page has sent, once; return its version. Raise SetupError."""
    effects.remove(places.request)
    try:
        return Updater(places, effects).update(places.requested)
    finally:
        effects.remove(places.requested)


def page_address(places: InstallPlaces) -> str:
    """Return the page's address for other computers, by the installed configuration. Raise SetupError."""
    settings = read_usable_settings(places.config, places.data, None, None, {})
    return settings.base_url(f"{socket.gethostname().lower()}.local")


def _greet(places: InstallPlaces, effects: Effects) -> None:
    """Print the doctor's findings, and the link by which the first browser signs in."""
    with suppress(SetupError):
        # What is wrong with the configuration, the doctor says.
        echo(f"The page: {page_address(places)} (a name that ends in .local needs avahi-daemon)")
    with suppress(CommandFailedError):
        # Its status is 1 where something is wrong.
        echo(effects.run(places.command, "doctor", quiet=True, accepted=(0, 1)))
    with suppress(CommandFailedError):
        echo(effects.run(places.command, "pair", quiet=True))
