"""`mucat certificate`: the certificates of simulators on other computers."""

from pathlib import Path

import click

from server.platform.authority import Authority
from server.platform.command_line import FILE, with_settings
from server.platform.folder_lock import runner_of
from server.platform.settings import Settings
from server.platform.terminal import echo

RESTART = "The running robot takes note when mucat run is ended and started again."


@click.group()
def certificate() -> None:
    """Issue and revoke the certificates of simulators on other computers."""


@certificate.command()
@click.argument("name")
@click.option("--to", "destination", type=FILE, help="New folder for it.  [default: mucat-NAME]")
@with_settings
def issue(settings: Settings, name: str, destination: Path | None) -> None:
    """Make a certificate with its key for a simulator of this name."""
    folder = destination or Path(f"mucat-{name}")
    Authority(settings).issue(name, folder)
    echo(f"Copy the folder {folder} to the other computer, and remove it here. There:")
    echo(f"  mucat simulator --connect tls/ADDRESS:PORT --certificate {folder.name} --robot {settings.robot}")
    _say_restart(settings)


@certificate.command()
@click.argument("name")
@with_settings
def revoke(settings: Settings, name: str) -> None:
    """Revoke a certificate from the next start of the robot on."""
    Authority(settings).revoke(name)
    echo(f"The certificate {name} is revoked.")
    _say_restart(settings)


@certificate.command("list")
@with_settings
def list_certificates(settings: Settings) -> None:
    """List the certificates in force."""
    found = Authority(settings).issued()
    for one in found:
        echo(f"{one.issued:%Y-%m-%d %H:%M}  {one.name}")
    if not found:
        echo("There is none: mucat certificate issue NAME makes one.")


def _say_restart(settings: Settings) -> None:
    if runner_of(settings.data) is not None:
        echo(RESTART)
