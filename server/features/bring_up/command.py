"""`mucat bring-up`: the bring-up from a shell, on a real board, if no server uses the data folder."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import click

from robot_runtime.durable_files import write_whole
from server.platform.command_line import with_settings
from server.platform.folder_lock import claim
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo

if TYPE_CHECKING:
    from robot_runtime.experiments.bring_up.guide import Action, Question, Step
    from robot_runtime.experiments.bring_up.procedure import BringUp, Given
    from server.board_reservation import RobotBoard

HOLD_POSTS = 6
HOLD_SECONDS = 0.1
"""A shell cannot feel a held key: each press of Enter turns the motor for these posts."""


@click.command("bring-up")
@with_settings
def bring_up(settings: Settings) -> int:
    """Check a new robot's parts one after the other, and calibrate it.

    For the robot's own board (robot.mode = "robot"). The page does the same, with pictures. At the end the
    robot's firmware is on its board again, and the report is bring-up.html in the data folder.
    """
    from robot_runtime.places import FIRMWARE_REMEDY
    from robot_runtime.simulation.boards.firmware import bring_up_path
    from server.platform.pidfile import end_parts

    if settings.emulated_board:
        raise SetupError(
            "The emulated robot's board runs only while the server does. Start `mucat run --uncalibrated`, "
            "and the bring-up from its page."
        )
    sketch = bring_up_path(settings.build, settings.link.baud)
    if not sketch.exists():
        raise SetupError(f"There is no {sketch}; {FIRMWARE_REMEDY}.")
    with claim(settings.data):
        end_parts(settings.data.run)
        return _perform(settings, sketch)


def _perform(settings: Settings, sketch: Path) -> int:
    from robot_runtime.errors import RefusedError
    from robot_runtime.experiments.bring_up.bench import BenchError, SerialBench
    from robot_runtime.experiments.bring_up.procedure import BringUp
    from server.board_reservation import RobotBoard
    from server.features.bring_up.report import write_report

    board = RobotBoard(settings, lambda _kind, _severity, text: echo(text, err=True))
    try:
        with asyncio.Runner() as runner, _reserved(runner, board) as arguments:
            echo("The bring-up's sketch is uploaded to the board.")
            if trouble := runner.run(board.upload(sketch)):
                raise SetupError(f"The sketch is not on the board: {trouble}")
            port = arguments[arguments.index("--port") + 1]
            try:
                with SerialBench(port, settings.link.baud) as bench:
                    procedure = BringUp(bench)
                    _guide(procedure)
            except (click.Abort, KeyboardInterrupt):
                echo("\nEnded. The robot's firmware is uploaded again.", err=True)
                raise
            except BenchError as problem:
                raise SetupError(str(problem)) from problem
            report = write_report(settings.robot.name, datetime.now(UTC), procedure)
            try:
                write_whole(settings.data.bring_up, report.encode())
            except OSError as problem:
                raise SetupError(f"The report could not be written: {problem.strerror}.") from problem
            echo(f"The report is {settings.data.bring_up}. The robot's firmware is uploaded again.")
    except RefusedError as problem:
        raise SetupError(str(problem)) from problem
    return 0 if not procedure.calibration().missing and not board.problem else 1


@contextmanager
def _reserved(runner: asyncio.Runner, board: "RobotBoard") -> Iterator[list[str]]:
    """Reserve the board from the main thread: a prompt in any other thread would not end at Ctrl-C."""
    reservation = board.reserve("The bring-up")
    arguments = runner.run(reservation.__aenter__())
    try:
        yield arguments
    finally:
        runner.run(reservation.__aexit__(None, None, None))


def _guide(procedure: "BringUp") -> None:
    from robot_runtime.experiments.bring_up.guide import STEPS

    for number, step in enumerate(STEPS, start=1):
        echo(f"\n{number}/{len(STEPS)}  {step.title}\n{step.about}\nExpected: {step.expected}")
        while True:
            ended = _do_actions(procedure, step)
            for result in procedure.results(step.name):
                mark = {"good": "ok  ", "note": "note", "wrong": "BAD "}[result.verdict]
                echo(f"  {mark} {result.what}: {result.measured}  {result.advice}".rstrip())
            if ended or procedure.state(step.name) != "wrong" or not click.confirm("Again?", default=True):
                break
        if ended:
            return


def _do_actions(procedure: "BringUp", step: "Step") -> bool:
    """Perform all actions of a step; return True where the person wants to end."""
    from robot_runtime.errors import RefusedError
    from robot_runtime.experiments.bring_up.guide import SKIP

    for action in step.actions:
        if action.name == "keep":
            continue
        keys = "Enter" + (", k: keep the default" if _can_keep(step) else "") + ", s: skip this step, q: end"
        key = click.prompt(f"{action.label} [{keys}]", default="", show_default=False)
        if key == "q":
            return True
        if key == "s":
            procedure.perform(step.name, SKIP, {})
            return False
        try:
            if key == "k" and _can_keep(step):
                procedure.perform(step.name, "keep", {})
                return False
            _act(procedure, step, action)
        except RefusedError as problem:
            echo(f"  {problem}", err=True)
    return False


def _can_keep(step: "Step") -> bool:
    return any(action.name == "keep" for action in step.actions)


def _act(procedure: "BringUp", step: "Step", action: "Action") -> None:
    import time

    given: Given = {}
    if action.inputs:
        given = {question.name: value for question in action.inputs if (value := _ask(question)) is not None}
    if action.kind == "press":
        procedure.perform(step.name, action.name, given)
        return
    for post in range(HOLD_POSTS):
        procedure.perform(step.name, action.name, {"on": post})
        time.sleep(HOLD_SECONDS)
    procedure.perform(step.name, action.name, {"stop": 1})


def _ask(question: "Question") -> float | str | None:
    if question.choices:
        return str(click.prompt(question.label, type=click.Choice(question.choices)))
    text = click.prompt(f"{question.label} ({question.unit})", default="" if question.optional else None)
    try:
        return float(text) if text else None
    except ValueError:
        return str(text)
