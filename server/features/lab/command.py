"""`mucat lab`: a lab, and its robots."""

from pathlib import Path

import click

from robot_runtime.contract.text_input import TextError, load_text
from server.platform.command_line import FILE, with_settings
from server.platform.running_server import ask
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo


@click.group()
def lab() -> None:
    """Run a lab: a server without a robot, which keeps the sessions of several."""


@click.command("add")
@click.argument("name")
@click.argument("url")
@click.option("--certificate", type=FILE, help="The robot's certificate, its file tls/certificate.pem.")
@with_settings
def add_robot(settings: Settings, name: str, url: str, certificate: Path | None) -> None:
    """Have the running lab pull the sessions of a robot.

    It asks for a token of the robot with the scope "operate" (People, on the robot's page).
    """
    token = click.prompt("Token of the robot", hide_input=True)
    try:
        text = "" if certificate is None else load_text(certificate)
    except OSError as problem:
        raise SetupError(f"{certificate} cannot be read: {problem}.") from problem
    except TextError as problem:
        raise SetupError(f"{certificate} cannot be read: it {problem}.") from problem
    robot = {"name": name, "url": url, "token": token, "certificate": text}
    ask(settings.data, "POST", "/lab/robots", robot)
    echo(f"The lab pulls from {name} whenever it is disarmed and reachable.")
