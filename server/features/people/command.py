"""`mucat pair` and `mucat access`: pairing and roles from the shell of the robot's own computer.

The running server does the work. The token in its data folder identifies this shell.
"""

import sys
from datetime import UTC, datetime
from typing import Any

import click

from server.platform.command_line import with_settings
from server.platform.running_server import ask
from server.platform.settings import DataFolder, Settings
from server.platform.terminal import echo

ROLE = click.Choice(["viewer", "operator"])
SCOPE = click.Choice(["read", "operate", "administer"])


@click.command()
@click.option("--role", type=ROLE, help="Default: viewer, or operator while there is none.")
@with_settings
def pair(settings: Settings, role: str | None) -> None:
    """Print a link that signs one browser in."""
    from server.http.sign_in.welcome import invitation, shows_pictures

    role = role or ("viewer" if _has_operator(settings.data) else "operator")
    made = ask(settings.data, "POST", "/access/codes", {"role": role})
    lines = invitation(made["link"], made["other_links"], picture=shows_pictures(sys.stdout))
    click.echo("\n".join([*lines, f"It makes the browser {_named(role)}."]))


@click.group()
def access() -> None:
    """Show and change the paired browsers and programs, and their roles."""


@access.command("list")
@with_settings
def list_devices(settings: Settings) -> None:
    """List the paired browsers and programs."""
    devices = ask(settings.data, "GET", "/access/devices")
    echo(_tabulate(devices) or "Nobody is paired yet: `mucat pair` prints a link for a browser.")


@access.command()
@click.argument("device", type=int)
@with_settings
def promote(settings: Settings, device: int) -> None:
    """Make a device an operator."""
    _give_role(settings.data, device, "operator")


@access.command()
@click.argument("device", type=int)
@with_settings
def demote(settings: Settings, device: int) -> None:
    """Make a device a viewer."""
    _give_role(settings.data, device, "viewer")


@access.command()
@click.argument("device", type=int)
@with_settings
def revoke(settings: Settings, device: int) -> None:
    """Revoke a device's access at once."""
    ask(settings.data, "DELETE", f"/access/devices/{device}")
    echo(f"The access of device {device} is revoked.")


@access.command()
@click.argument("name")
@click.option("--scope", type=SCOPE, default="read", help="What it may do.")
@click.option("--days", type=click.IntRange(1, 3650), default=90, help="Days until it ends.")
@click.option("--never-ends", is_flag=True, help="Instead of --days.")
@with_settings
def token(settings: Settings, name: str, scope: str, days: int, never_ends: bool) -> None:
    """Make a token for a program of this name, and print it."""
    body = {"name": name, "scope": scope, "days": None if never_ends else days}
    made = ask(settings.data, "POST", "/access/tokens", body)
    device = made["device"]
    # To standard error: another program may read the token from standard output.
    echo(f"“{device['name']}” is device {device['id']}. The token is not shown again:", err=True)
    echo(made["token"])


def _has_operator(folder: DataFolder) -> bool:
    devices = ask(folder, "GET", "/access/devices")
    return any((device["kind"], device["role"]) == ("browser", "operator") for device in devices)


def _give_role(folder: DataFolder, number: int, role: str) -> None:
    device = ask(folder, "PATCH", f"/access/devices/{number}", {"role": role})
    echo(f"“{device['name']}” is {_named(role)} now.")


def _named(role: str) -> str:
    return "an operator" if role == "operator" else "a viewer"


def _tabulate(devices: list[dict[str, Any]]) -> str:
    return "\n".join(
        f"{device['id']:5}  {device['role']:8}  {device['kind']:7}  "
        f"last seen {datetime.fromtimestamp(device['seen'], UTC):%Y-%m-%d %H:%M} UTC  "
        f"{_rights(device)}{device['name']}"
        for device in devices
    )


def _rights(device: dict[str, Any]) -> str:
    """Return a token's scope and end as text; empty where both are the default."""
    limited = "does not administer  " if device["limited"] and device["role"] == "operator" else ""
    if device["ended"] or device["ends"] is None:
        return limited + (f"{device['ended']}  " if device["ended"] else "")
    return f"{limited}ends {datetime.fromtimestamp(device['ends'], UTC):%Y-%m-%d %H:%M} UTC  "
