"""`mucat commtest`: run, list, show, compare and export communication tests from a shell."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from server.platform.command_line import FILE, with_settings
from server.platform.folder_lock import claim
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo

if TYPE_CHECKING:
    from robot_runtime.experiments.comm_test.document import CommTest
    from server.features.comm_tests.reference import GridPlace
    from server.features.comm_tests.runs import CommTestRuns
    from server.platform.csv_cells import Spreadsheet

RUN = click.argument("run", type=int)


@click.group()
def commtest() -> None:
    """Test the serial line, on the emulated board or the robot's."""


@commtest.command("run")
@click.argument("file", type=FILE)
@click.option(
    "--place",
    "board",
    type=click.Choice(["emulated", "robot"]),
    help="Boards of its own in emulated time, or the robot's board in real time. Default: as robot.mode.",
)
@with_settings
def run_document(settings: Settings, file: Path, board: Literal["emulated", "robot"] | None) -> int:
    """Run the tests of a document (JSON)."""
    from server.features.comm_tests.shell_run import run_tests
    from server.platform.pidfile import end_parts

    text, tests = _read(file)
    if board == "robot" and settings.emulated_board:
        raise SetupError(
            "The emulated robot's board runs only while the server does. Start the test from the page, or "
            "leave --place out."
        )
    board = board or ("emulated" if settings.emulated_board else "robot")
    with ExitStack() as claimed:
        try:
            claimed.enter_context(claim(settings.data))
        except SetupError as problem:
            raise SetupError(f"{problem} Beside a running server, start the test from its page.") from problem
        end_parts(settings.data.run)
        return run_tests(text, tests, board, settings)


@commtest.command("list")
@with_settings
def list_runs(settings: Settings) -> None:
    """List the recorded runs."""
    from server.features.comm_tests import tables

    with _open_runs(settings) as runs:
        echo(tables.show_list(runs.list()))


@commtest.command()
@RUN
@with_settings
def show(settings: Settings, run: int) -> None:
    """Show a run: configuration, rate, reasons."""
    from server.features.comm_tests import tables

    with _open_runs(settings) as runs:
        echo(tables.show_run(runs.find(run), runs.cells(run)))


@commtest.command()
@click.argument("runs", nargs=-1, required=True, metavar="RUN...")
@with_settings
def compare(settings: Settings, runs: tuple[str, ...]) -> None:
    """Show runs side by side.

    A RUN is a number, or table5 or table6: those of the thesis.
    """
    from server.features.comm_tests import tables

    with _open_runs(settings) as runs_store:
        echo(tables.show_comparison({name: _rates(runs_store, name) for name in runs}))


@commtest.command()
@RUN
@click.option("--format", type=click.Choice(["csv", "json"]), default="csv")
@click.option(
    "--spreadsheet",
    type=click.Choice(["none", "point", "comma"]),
    default="none",
    help="The decimal sign of the spreadsheet that reads the CSV.",
)
@with_settings
def export(settings: Settings, run: int, format: str, spreadsheet: "Spreadsheet") -> None:  # noqa: A002
    """Write a run to the standard output."""
    from server.features.comm_tests import tables
    from server.platform.csv_cells import STYLES

    with _open_runs(settings) as runs:
        row, cells = runs.find(run), runs.cells(run)
    if format == "csv":
        echo(tables.write_csv(row, cells, STYLES[spreadsheet]), nl=False)
    else:
        echo(tables.write_json(row, cells), nl=False)


@contextmanager
def _open_runs(settings: Settings) -> "Iterator[CommTestRuns]":
    from server.features.comm_tests.runs import CommTestRuns
    from server.platform.shell_store import open_reader

    with open_reader(settings.data) as store:
        yield CommTestRuns(store)


def _rates(runs: "CommTestRuns", name: str) -> "dict[GridPlace, float]":
    from server.features.comm_tests import tables
    from server.features.comm_tests.reference import TABLES, read_table

    if name in TABLES:
        return read_table(name)
    if not name.isdecimal():
        raise SetupError(f"{name!r} is neither the number of a run nor one of {', '.join(TABLES)}.")
    runs.find(int(name))
    return tables.places(runs.cells(int(name)))


def _read(file: Path) -> "tuple[str, list[CommTest]]":
    from robot_runtime.contract.limits import ConfigError
    from robot_runtime.contract.text_input import TextError, load_text
    from robot_runtime.experiments.comm_test.document import read_document

    try:
        text = load_text(file)
        return text, read_document(text)
    except OSError as problem:
        raise SetupError(f"{file} cannot be read: {problem}") from problem
    except TextError as problem:
        raise SetupError(f"{file} cannot be read: it {problem}") from problem
    except ConfigError as problem:
        raise SetupError("\n  ".join([f"{file} cannot be run:", *problem.texts])) from problem
