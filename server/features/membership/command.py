"""`mucat lab join` and `mucat lab leave`, on a robot."""

import click

from server.platform.command_line import with_settings
from server.platform.running_server import ask
from server.platform.settings import Settings
from server.platform.terminal import echo

JOIN_SECONDS = 40.0


@click.command()
@click.argument("address")
@click.argument("code")
@with_settings
def join(settings: Settings, address: str, code: str) -> None:
    """Join the lab at ADDRESS, by a CODE that the lab has made."""
    joined = ask(settings.data, "POST", "/lab/join", {"address": address, "code": code}, JOIN_SECONDS)
    echo(f"This robot has joined the lab {joined['name']}. It dials it from now on, also after a start.")


@click.command()
@with_settings
def leave(settings: Settings) -> None:
    """Leave the lab."""
    notified = ask(settings.data, "DELETE", "/lab")["notified"]
    echo(
        "This robot has left the lab."
        if notified
        else "This robot has left the lab, which is not connected: remove it there, too."
    )
