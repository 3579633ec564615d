"""The commands of the tutorial and the task pages, run in a reader's order."""

import os
import re
import shlex
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import click
import pytest
from click.exceptions import Exit

from server.cli import mucat
from tests.documents.blocks import DOCS, read_blocks, read_commands
from tests.stack import Stack

ROOT = Path(__file__).parents[2]
MUCAT, PYTHON = ".venv/bin/mucat", ".venv/bin/python"

# Each page begins where the pages before it have left the data folder.
TUTORIAL = "use/tutorial.md"
AFTER_IT = (
    "use/start.md",
    "use/sessions.md",
    "use/scenarios.md",
    "use/missions.md",
    "use/compare.md",
    "use/export.md",
    "use/comm-tests.md",
    "run/install.md",
    "run/backup.md",
)
# Those of docs/run/packages.md are run by tests/packages and, in other systems, by `make packages`.
WITH_A_SERVER = ("run/access.md", "use/doors.md")
RUN_ELSEWHERE = {
    "run/lab.md": "tests/server/features/lab, and tests/server/features/exports/test_lake.py",
    "use/sweeps.md": "tests/server/features/sweeps has a scheduler and workers",
}
"""Pages whose commands need other computers, and what does the same."""
OF_DEVELOPERS = ("../README.md", "../CONTRIBUTING.md", "develop/testing.md")
RUN = (TUTORIAL, *AFTER_IT, *WITH_A_SERVER, *OF_DEVELOPERS)
"""Every page whose `sh` blocks are run."""


def run(commands: list[str], folder: Path) -> list[str]:
    """Return the output of each command. `make` is only asked if it knows the target."""
    printed = []
    for command in commands:
        name, *arguments = shlex.split(command)
        if name == "make":
            line, position = ["make", "--dry-run", *arguments], ROOT
        elif name == PYTHON:
            line, position = [str(ROOT / PYTHON), *arguments], ROOT
        else:
            assert name == MUCAT, f"{command} cannot be run by this test"
            line, position = [str(ROOT / MUCAT), *arguments], folder
        environment = os.environ | {"MUCAT_DATA": str(folder / "data")}
        done = subprocess.run(
            line, cwd=position, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        printed.append(done.stdout)
    return printed


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the tutorial's commands have run."""
    path = tmp_path_factory.mktemp("reader")
    (path / "robot.toml").write_text((ROOT / "robot.toml").read_text())
    (path / "server").symlink_to(ROOT / "server")
    run(read_commands(TUTORIAL), path)
    return path


def test_the_tutorial_ends_with_a_report_and_a_zip_file(folder: Path) -> None:
    assert "Figure 14" in (folder / "report.html").read_text()
    assert (folder / "dive.zip").read_bytes().startswith(b"PK")


def test_the_program_of_the_export_reads_the_file_of_the_tutorial(folder: Path) -> None:
    (block,) = (block for block in read_blocks("use/export.md") if block.language == "python")
    line = [sys.executable, "-c", block.text]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "mean" in done.stdout


@pytest.mark.parametrize("page", AFTER_IT)
def test_the_commands_of_a_page_can_be_run(folder: Path, page: str) -> None:
    commands = read_commands(page)
    assert commands
    run(commands, folder)


@pytest.mark.parametrize("page", OF_DEVELOPERS)
def test_the_commands_of_a_page_for_developers_can_be_run(tmp_path: Path, page: str) -> None:
    run(read_commands(page), tmp_path)


@pytest.mark.stack
@pytest.mark.parametrize("page", WITH_A_SERVER)
def test_the_commands_of_a_page_can_be_run_beside_a_server(shared_stack: Stack, page: str) -> None:
    folder = shared_stack.data.parent
    (folder / "robot.toml").write_text((ROOT / "robot.toml").read_text())
    run(read_commands(page), folder)


def test_every_command_of_an_installed_robot_exists_with_its_options() -> None:
    pages = [page.read_text(encoding="utf-8") for page in (DOCS / "run").rglob("*.md")]
    match = re.findall(r"(?:^ *|`)(?:sudo )?mucat ([^`\n]+)", "\n".join(pages), re.MULTILINE)
    commands = [shlex.split(parts.split("\\|")[0]) for parts in match]
    assert len(commands) > 30
    for text in commands:
        if not text[0].startswith(("-", "COMMAND")):
            check_command(mucat, text)


def check_command(command: click.Command, message: list[str], above: click.Context | None = None) -> None:
    """Fail for a command or an option that click does not know; FILE and other words may stand for values."""
    context = click.Context(command, above)
    if isinstance(command, click.Group):
        name, result, rest = command.resolve_command(context, message)
        assert name is not None
        assert result is not None
        check_command(result, rest, context)
    else:
        with suppress(click.BadParameter, Exit):
            command.make_context(command.name, message, above)


def test_every_page_of_tasks_with_commands_is_run() -> None:
    pages = [
        str(page.relative_to(DOCS)) for position in ("use", "run") for page in (DOCS / position).glob("*.md")
    ]
    assert {page for page in pages if read_commands(page)} == {
        TUTORIAL,
        *AFTER_IT,
        *WITH_A_SERVER,
        *RUN_ELSEWHERE,
    }
