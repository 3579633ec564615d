"""`mucat scenario`: list, check and run scenarios from a shell."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from server.platform.command_line import TAKE_OVER, CommandError, with_settings
from server.platform.data_path import SCENARIOS
from server.platform.name_completion import complete_document, folder_of
from server.platform.terminal import echo

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from robot_runtime.experiments.scenario.document import Scenario
    from server.platform.settings import Settings


def _complete(ctx: click.Context, _: click.Parameter, incomplete: str) -> "list[CompletionItem]":
    from robot_runtime.experiments.scenario.library import SHIPPED

    return complete_document(SHIPPED, folder_of(ctx) / SCENARIOS, incomplete)


SCENARIO = click.argument("file", metavar="SCENARIO", shell_complete=_complete)


@click.group()
def scenario() -> None:
    """Check and run scenarios: experiments in TOML.

    A SCENARIO is a TOML file, or the name of one in the list.
    """


@scenario.command("list")
@with_settings
def list_all(settings: "Settings") -> None:
    """List the scenarios."""
    from server.features.scenarios.library import list_scenarios

    for entry in list_scenarios(settings.data.scenarios):
        echo(f"{entry.name:<24} {entry.title}{'' if entry.shipped else ' (your own)'}")


@scenario.command()
@SCENARIO
@with_settings
def check(settings: "Settings", file: str) -> None:
    """Show a scenario's events, or its problems."""
    _, scenario = _read(file, settings.data.scenarios)
    echo(_describe(scenario))


@scenario.command()
@SCENARIO
@click.option(
    "--place",
    "timing",
    type=click.Choice(["simulated", "live"]),
    default="simulated",
    help="In simulated time, or in real time on the robot of the running server.",
)
@click.option(
    "--board",
    type=click.Choice(["host", "emulated"]),
    default="host",
    help="In simulated time: the firmware built for this computer, or on the emulated board.",
)
@TAKE_OVER
@with_settings
def run(
    settings: "Settings",
    file: str,
    timing: Literal["simulated", "live"],
    board: Literal["host", "emulated"],
    take_over: bool,
) -> int:
    """Run a scenario, and record it as a session."""
    from server.features.scenarios.schemas import ScenarioStart
    from server.features.scenarios.shell_run import run_scenario

    text, _ = _read(file, settings.data.scenarios)
    return run_scenario(ScenarioStart(text=text, place=timing, board=board), settings, take_over=take_over)


def _read(file: str, own: Path) -> "tuple[str, Scenario]":
    from robot_runtime.contract.limits import ConfigError
    from robot_runtime.contract.text_input import TextError, load_text
    from robot_runtime.experiments.scenario.document import read_scenario
    from server.features.scenarios.library import list_scenarios

    there = {entry.name: entry.text for entry in list_scenarios(own)}
    try:
        text = there[file] if file in there else load_text(Path(file))
        return text, read_scenario(text)
    except TextError as problem:
        raise CommandError(f"{file} cannot be read: it {problem}") from problem
    except OSError as problem:
        known = ", ".join(there)
        raise CommandError(f"{file} cannot be read: {problem}. Known scenarios: {known}") from problem
    except ConfigError as problem:
        raise CommandError("\n  ".join([f"{file} cannot be run:", *problem.texts])) from problem


def _describe(scenario: "Scenario") -> str:
    from server.features.scenarios.schemas import summarize

    summary = summarize(scenario)
    events = [f"{event.at:8.1f} s  {event.words}" for event in summary.events]
    return "\n".join([f"{summary.title}: {summary.duration:g} s, seed {summary.seed}", *events])
