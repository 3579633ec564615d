"""`mucat certificate`: the certificates of simulators on other computers, and of ROS 2 programs."""

import json
from pathlib import Path

import click

from robot_runtime.transport.network import AUTHORITY, CERTIFICATE, KEY
from server.features.doors.config import DoorsConfig
from server.http.sign_in.tokens import digest
from server.platform.authority import Authority, check_name
from server.platform.command_line import FILE, with_settings
from server.platform.folder_lock import runner_of
from server.platform.running_server import ask
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo

RESTART = "The running robot takes note when mucat run is ended and started again."


@click.group()
def certificate() -> None:
    """Issue certificates of simulators and ROS 2 programs, and revoke those of simulators."""


@certificate.command()
@click.argument("name")
@click.option("--to", "destination", type=FILE, help="New folder for it.  [default: mucat-NAME]")
@with_settings
def issue(settings: Settings, name: str, destination: Path | None) -> None:
    """Make a certificate with its key for a simulator of this name."""
    folder = destination or Path(f"mucat-{name}")
    Authority(settings).issue(name, folder)
    echo(f"Copy the folder {folder} to the other computer, and remove it here. There:")
    robot = settings.robot.name
    echo(f"  mucat simulator --connect tls/ADDRESS:PORT --certificate {folder.name} --robot {robot}")
    _say_restart(settings)


@certificate.command()
@click.argument("name")
@click.option(
    "--scope",
    type=click.Choice(["read", "operate"]),
    default="read",
    help="What it may do: see everything, or also take control.",
)
@click.option("--days", type=click.IntRange(1, 3650), default=90, help="Days until it ends.")
@click.option("--to", "destination", type=FILE, help="New folder for it.  [default: mucat-NAME]")
@with_settings
def ros2(settings: Settings, name: str, scope: str, days: int, destination: Path | None) -> None:
    """Make a certificate with its key for a ROS 2 program or router of this name.

    The program is listed under People, and revoked there.
    """
    check_name(name)
    folder = destination or Path(f"mucat-{name}")
    if folder.exists():
        raise SetupError(f"{folder} exists. Remove it, or choose another folder with --to.")
    made = ask(settings.data, "POST", "/access/tokens", {"name": name, "scope": scope, "days": days})
    device = made["device"]["id"]
    try:
        # The program shows the certificate instead of its token, which nobody keeps.
        Authority(settings).issue_program(digest(made["token"]), folder)
    except SetupError:
        ask(settings.data, "DELETE", f"/access/devices/{device}")
        raise
    echo(f"“{name}” is device {device}. Copy the folder {folder} to its computer, and remove it here.")
    echo("There, in the folder's place, with the robot's address:")
    door = settings.section(DoorsConfig)
    echo(f"  {override(folder.name, door.ros2_listen)} ros2 run rmw_zenoh_cpp rmw_zenohd")
    if not door.ros2:
        echo("The door is closed: set ros2 = true under [doors] in robot.toml.")


def override(folder: str, listen: str) -> str:
    """Return the environment variable with which rmw_zenoh connects by the certificate in this folder."""
    values = {
        "connect/endpoints": [f"tls/ADDRESS:{listen.rpartition(':')[2]}"],
        "transport/link/tls": {
            "root_ca_certificate": f"{folder}/{AUTHORITY}",
            "connect_certificate": f"{folder}/{CERTIFICATE}",
            "connect_private_key": f"{folder}/{KEY}",
            "enable_mtls": True,
            "verify_name_on_connect": False,
        },
    }
    text = ";".join(f"{key}={json.dumps(value, separators=(',', ':'))}" for key, value in values.items())
    return f"ZENOH_CONFIG_OVERRIDE='{text}'"


@certificate.command()
@click.argument("name")
@with_settings
def revoke(settings: Settings, name: str) -> None:
    """Revoke a simulator's certificate from the next start of the robot on."""
    Authority(settings).revoke(name)
    echo(f"The certificate {name} is revoked.")
    _say_restart(settings)


@certificate.command("list")
@with_settings
def list_certificates(settings: Settings) -> None:
    """List the simulators' certificates in force."""
    issued = Authority(settings).issued()
    for entry in issued:
        echo(f"{entry.issued:%Y-%m-%d %H:%M} UTC  {entry.name}")
    if not issued:
        echo("There is none: mucat certificate issue NAME makes one.")


def _say_restart(settings: Settings) -> None:
    if runner_of(settings.data) is not None:
        echo(RESTART)
