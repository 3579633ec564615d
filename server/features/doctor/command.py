"""`mucat doctor`: examines the computer, and prints its problems with their remedies."""

import json
import os
import time
from dataclasses import asdict, replace
from pathlib import Path

import click

from server.features.doctor.checks import examine
from server.features.doctor.findings import print_findings, worst
from server.features.doctor.machine import Machine, read_machine
from server.platform.command_line import CommandError, config_option, data_option
from server.platform.folder_lock import runner_of
from server.platform.last_configuration import read_usable_settings
from server.platform.running_server import ask
from server.platform.settings import Settings, SetupError, data_folder, find_config
from server.platform.terminal import echo


@click.command()
@data_option
@config_option
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON, for programs.")
def doctor(data: Path | None, config: Path | None, *, as_json: bool) -> int:
    """Examine this computer: its problems, their meaning and their remedies.

    It changes nothing. The exit status is 1 where something is wrong.
    """
    try:
        findings = examine(_look(config, data))
    except PermissionError as problem:
        raise CommandError(
            f"This user may not read {problem.filename}. On an installed robot: sudo mucat doctor"
        ) from problem
    if as_json:
        echo(json.dumps([asdict(finding) for finding in findings], indent=2))
    else:
        print_findings(findings, echo)
    return 1 if worst(findings) == "wrong" else 0


def _look(config: Path | None, data: Path | None) -> Machine:
    try:
        settings = read_usable_settings(config, data, None, None, os.environ)
    except SetupError as problem:
        folder = data_folder(data, os.environ)
        settings = Settings(data=folder, config=(config or find_config(folder)).absolute())
        return replace(read_machine(settings, time.time()), configuration_problem=str(problem))
    return read_machine(settings, time.time(), _ask_health(settings))


def _ask_health(settings: Settings) -> dict[str, tuple[str, str]]:
    """Return state and text of each part, by the running server; empty without one."""
    if runner_of(settings.data) is None:
        return {}
    try:
        health = ask(settings.data, "GET", "/health")
    except SetupError:
        # It may be starting: that says nothing about the board.
        return {"link": ("starting", "Not asked: the server does not answer.")}
    return {part["name"]: (part["state"], part["text"]) for part in health["parts"]}
