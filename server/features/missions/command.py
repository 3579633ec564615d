"""`mucat mission`: list, check, try, run and show missions from a shell."""

from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Any

import click

from server.platform.command_line import TAKE_OVER, CommandError, with_settings
from server.platform.data_path import MISSIONS
from server.platform.name_completion import complete_document, folder_of
from server.platform.terminal import echo

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from robot_runtime.missions.document import MissionDocument
    from server.features.missions.schemas import MissionTrialResult
    from server.platform.settings import Settings

POLL_SECONDS = 0.5
SILENT_SECONDS = 2.0
"""A running mission tells its state twice as often."""


def _complete(ctx: click.Context, _: click.Parameter, incomplete: str) -> "list[CompletionItem]":
    from robot_runtime.missions.library import SHIPPED

    return complete_document(SHIPPED, folder_of(ctx) / MISSIONS, incomplete)


MISSION = click.argument("file", metavar="MISSION", shell_complete=_complete)


@click.group()
def mission() -> None:
    """Check, try and run missions: the robot's autonomous tasks.

    A MISSION is a TOML file, or the name of one in the list.
    """


@mission.command("list")
@with_settings
def list_all(settings: "Settings") -> None:
    """List the missions."""
    from server.features.missions.library import MissionLibrary

    for entry in MissionLibrary(settings.data.missions, settings.mission_limits).describe():
        own = "" if entry.shipped else f" (your own, version {entry.versions})"
        echo(f"{entry.name:<24} {entry.title}{own}")


@mission.command()
@MISSION
@with_settings
def check(settings: "Settings", file: str) -> None:
    """Show the problems of a mission, if any."""
    from robot_runtime.config import load
    from robot_runtime.contract.limits import ConfigError
    from robot_runtime.missions.checks import check_sights

    _, read = _read(file, settings)
    echo(f"{read.title}: {read.longest:.0f} s at most, {len(list(read.root.walk()))} steps, no problem.")
    try:
        unseen = check_sights(read, load(settings.config).vision.settings)
    except ConfigError as problem:
        raise CommandError(str(problem)) from problem
    if unseen:
        echo("\n".join([f"But with the vision of {settings.config} it would not begin:", *unseen]))


@mission.command()
@MISSION
@with_settings
def show(settings: "Settings", file: str) -> None:
    """Show a mission's steps, its longest time and its limits."""
    _, read = _read(file, settings)
    limits = read.limits
    echo(f"{read.title}: {read.longest:.0f} s at most")
    echo(f"limits: {limits.depth:g} m, {limits.time:g} s, {limits.battery:g} V, pause {limits.pause:g} s")
    for step in read.root.walk():
        indent = "  " * len(step.path)
        note = f" ({step.node.note})" if step.node.note else ""
        echo(f"{indent}{step.number or '-'} {step.node.label}{note}")


@mission.command("try")
@MISSION
@click.option("--seeds", type=click.IntRange(1, 100), default=20, help="How many; each has its own noise.")
@with_settings
def try_out(settings: "Settings", file: str, seeds: int) -> int:
    """Try a mission in simulated water, once for each seed: successes, durations, depths, failed steps."""
    import asyncio

    from server.features.missions.library import MissionLibrary
    from server.features.missions.trials import MissionTrials

    text, read = _read(file, settings)
    called = MissionLibrary(settings.data.missions, settings.mission_limits).called_by(text)

    async def perform() -> MissionTrials:
        trials = MissionTrials(settings)
        trials.start(read.name, text, called, seeds)
        await trials.wait()
        return trials

    trial = asyncio.run(perform()).state()
    for result in trial.results:
        outcome = result.phase or "did not begin"
        measured = f"{result.elapsed:7.1f} s  {result.deepest:5.2f} m"
        echo(f"seed {result.seed:>3}  {outcome:<9} {measured}  {result.text}")
    if trial.problem:
        raise CommandError(trial.problem)
    good = [result for result in trial.results if result.phase == "succeeded"]
    echo(f"{len(good)} of {seeds} succeeded.{_describe_span(good)}")
    return 0 if len(good) == seeds else 1


def _describe_span(good: "list[MissionTrialResult]") -> str:
    if not good:
        return ""
    times, depths = [result.elapsed for result in good], [result.deepest for result in good]
    return f" They took {min(times):.1f} to {max(times):.1f} s and went down to {max(depths):.2f} m."


@mission.command()
@MISSION
@TAKE_OVER
@with_settings
def run(settings: "Settings", file: str, take_over: bool) -> int:
    """Arm the robot of the running server, begin a mission, and follow it to its end. Ctrl-C ends it."""
    from server.driving.shell_control import in_control, renew_control
    from server.platform.running_server import ask

    text, read = _read(file, settings)
    folder = settings.data
    with in_control(folder, over=take_over):
        last = ask(folder, "GET", "/missions/state")
        before = float("-inf") if last is None else last["time"]
        ask(folder, "POST", "/missions/start", {"text": text}, seconds=30.0)
        echo(f"{read.title} begins.")
        seen = ask(folder, "GET", "/robot")["time"]
        shown: set[tuple[str, str, int]] = set()
        try:
            while True:
                renew_control(folder)
                state = ask(folder, "GET", "/missions/state")
                # Not by its number: a runtime that was restarted counts from 1 again.
                if state is not None and _began(state) > before:
                    seen = state["time"]
                    _print_changes(state, shown)
                    if state["phase"] not in ("running", "paused"):
                        echo(f"{state['phase']}: {state['text']}")
                        return 0 if state["phase"] == "succeeded" else 1
                _require_swimming(seen, ask(folder, "GET", "/robot"))
                sleep(POLL_SECONDS)
        except KeyboardInterrupt:
            ask(folder, "POST", "/robot/commands/mission_end")
            raise CommandError("The mission was ended.") from None


def _began(state: dict[str, Any]) -> float:
    """Return the time at which a mission began, s of the steady clock."""
    return float(state["time"] - state["elapsed"] - state["paused"])


def _require_swimming(seen: float, robot: dict[str, Any]) -> None:
    """Raise CommandError where the robot was disarmed without the mission's end: its runtime was killed.

    `seen`: the time of its newest state, s of the steady clock.
    """
    if not robot["armed"] and robot["time"] > seen + SILENT_SECONDS:
        raise CommandError("The mission broke off: the runtime was restarted. The robot is disarmed.")


def _print_changes(state: dict[str, Any], shown: set[tuple[str, str, int]]) -> None:
    for step in state["steps"]:
        change = (step["path"], step["status"], step["rounds"])
        if step["status"] != "waiting" and change not in shown:
            shown.add(change)
            echo(f"{state['elapsed']:8.1f} s  {step['path'] or '-'} {step['words']}: {step['status']}")


def _read(file: str, settings: "Settings") -> "tuple[str, MissionDocument]":
    from robot_runtime.contract.limits import ConfigError
    from robot_runtime.contract.text_input import TextError, load_text
    from server.features.missions.library import MissionLibrary

    library = MissionLibrary(settings.data.missions, settings.mission_limits)
    there = library.texts()
    try:
        text = there[file] if file in there else load_text(Path(file))
        return text, library.read(text)
    except TextError as problem:
        raise CommandError(f"{file} cannot be read: it {problem}") from problem
    except OSError as problem:
        raise CommandError(
            f"{file} cannot be read: {problem}. Known missions: {', '.join(there)}"
        ) from problem
    except ConfigError as problem:
        raise CommandError("\n  ".join([f"{file} cannot be used:", *problem.texts])) from problem
