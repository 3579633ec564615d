"""Names that the shell completes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

from robot_runtime.clock import SimulatedClock
from server.cli import mucat
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import new_row


def complete(settings: Settings, *arguments: str) -> list[tuple[str, str | None]]:
    """Return what the shell offers for the last word, with its explanation."""
    *before, incomplete = arguments
    before[1:1] = ["--data", str(settings.data.path)] if before[0] in ("export", "report") else []
    items = ShellComplete(mucat, {}, "mucat", "_MUCAT_COMPLETE").get_completions(before, incomplete)
    return [(item.value, item.help) for item in items if item.type == "plain"]


@pytest.fixture
def here(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> Settings:
    """A data folder that the environment names."""
    monkeypatch.setenv("MUCAT_DATA", str(settings.data.path))
    return settings


async def test_a_session_is_found_by_its_number_and_by_its_name(here: Settings, store: Store) -> None:
    clock = SimulatedClock(50.0)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    for name in ("Pool at noon", "Sea trial", "gone"):
        session = await recorder.start(new_row(here, clock, name, "", "null"))
        await recorder.stop(session.id)
    await store.write(
        lambda connection: connection.exec_driver_sql("UPDATE session SET deleted = 1 WHERE id = 3")
    )
    first, second = ("1", "Pool at noon"), ("2", "Sea trial")
    assert complete(here, "sessions", "show", "") == [second, first]
    assert complete(here, "export", "2") == [second]
    assert complete(here, "report", "1", "noon") == [first]
    assert complete(here, "identify", "1", "--leave-out", "") == [second, first]


def test_a_shell_waits_for_no_library_that_names_do_not_need(tmp_path: Path) -> None:
    program = """
import sys
from click.shell_completion import ShellComplete
from server.cli import mucat
for words in ("sessions show", "export", "report", "identify", "scenario run", "mission try"):
    ShellComplete(mucat, {}, "mucat", "_MUCAT_COMPLETE").get_completions(words.split(), "")
slow = {"asyncio", "urllib.request", "robot_runtime.config", "robot_runtime.contract.limits"}
print(*slow & set(sys.modules))
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"MUCAT_DATA": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == []


def test_without_a_database_there_is_no_session(here: Settings) -> None:
    assert complete(here, "export", "") == []
    here.data.database.write_text("This is none.\n" * 1000)
    assert complete(here, "export", "") == []


@pytest.mark.parametrize(
    ("command", "beginning", "shipped"),
    [(("scenario", "run"), "fig", "figure_14"), (("mission", "try"), "first", "first_dive")],
)
def test_a_shipped_document_and_one_s_own_are_completed(
    here: Settings, command: tuple[str, str], beginning: str, shipped: str
) -> None:
    assert complete(here, *command, beginning) == [(shipped, None)]
    own = here.data.scenarios / "figure_of_mine.toml"
    if command[0] == "mission":
        own = here.data.missions / "first_of_mine"
    own.parent.mkdir()
    own.touch()
    assert complete(here, *command, beginning) == [(shipped, None), (own.stem, None)]
