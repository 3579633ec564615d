"""`mucat lab pair`, `robots`, `stop` and `remove`: a lab's robots from the shell of its own computer.

The running server does the work. The token in its data folder identifies this shell.
"""

from typing import Any

import click

from server.platform.command_line import with_settings
from server.platform.running_server import ask
from server.platform.settings import Settings
from server.platform.terminal import echo


@click.command()
@with_settings
def pair(settings: Settings) -> None:
    """Print a command that lets one robot join this lab."""
    made = ask(settings.data, "POST", "/robots/codes")
    echo("On the robot's computer, within ten minutes:")
    echo(f"  {made['command']}")


@click.command()
@with_settings
def robots(settings: Settings) -> None:
    """List the robots of this lab, and what its archive has of them."""
    listed = ask(settings.data, "GET", "/robots")
    pulls = {pull["robot"]: pull for pull in ask(settings.data, "GET", "/lab/pulls")}
    if listed["problem"]:
        echo(listed["problem"])
    for robot in listed["robots"]:
        echo(_line(robot))
        if (pull := pulls.get(robot["name"])) is not None:
            echo(f"  archive: sessions {pull['sessions']}, lacking {pull['lacking']}. {pull['text']}")
    if not listed["robots"]:
        echo("No robot has joined yet: mucat lab pair.")


@click.command()
@with_settings
def stop(settings: Settings) -> int:
    """Stop all robots of this lab at once. The exit status is 1 where one has not answered."""
    answers = ask(settings.data, "POST", "/robots/stop")
    for answer in answers:
        echo(f"{answer['name']}: " + ("stopped" if answer["stopped"] else "NOT STOPPED"))
        for way in ("zenoh", "https"):
            if answer[way]:
                echo(f"  {way}: {answer[way]}")
    return 0 if all(answer["stopped"] for answer in answers) else 1


@click.command()
@click.argument("robot")
@with_settings
def remove(settings: Settings, robot: str) -> None:
    """Remove a robot from this lab: it is let in no more."""
    ask(settings.data, "DELETE", f"/robots/{robot}")
    echo(f"{robot} is removed.")


def _line(robot: dict[str, Any]) -> str:
    presence = robot["presence"]
    if not robot["present"] or presence is None:
        return f"{robot['name']:32}  not connected"
    depth = "" if presence["depth"] is None else f"{presence['depth']:.2f} m"
    return f"{robot['name']:32}  {presence['mode'] or 'unknown':10}  {depth:8}  {robot['address']}"
