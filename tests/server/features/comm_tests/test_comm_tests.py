"""`mucat commtest`, from the document to the export, on the emulated board."""

import asyncio
import csv
import fcntl
import io
import json
import os
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.experiments.comm_test.document import read_document
from server.cli import main
from server.features.comm_tests import tables
from server.features.comm_tests.reference import read_table
from server.features.comm_tests.runs import CommTestStore
from server.features.comm_tests.shipped import THESIS, import_samples, shipped_documents
from server.platform.settings import Settings
from server.platform.store import Store
from tests.board.rig import ROOT, build
from tests.server.features.comm_tests.stored_runs import ENTRY, LOST, begin
from tests.server.new_database import new_store
from tests.server.older import upgrade_to
from tests.waiting import SECONDS


@pytest.fixture(scope="module", autouse=True)
def _board() -> None:
    build(ROOT / "firmware/emulator")


@pytest.fixture
def options(settings: Settings) -> list[str]:
    return ["--data", str(settings.data.path), "--config", str(settings.config)]


def write(folder: Path, *entries: dict[str, Any]) -> str:
    path = folder / "test.json"
    path.write_text(json.dumps(entries), encoding="utf-8")
    return str(path)


def test_run_show_compare_and_export(
    options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = write(tmp_path, ENTRY, ENTRY | {"framing": "plain", "direction": "both"})
    assert main(["commtest", "run", document, *options]) == 0
    output = capsys.readouterr().out
    assert "[  2/2] 115200 baud, Arduino 0.1 s, Pi 0.5 s" in output
    assert "0:00 remaining" in output
    assert "115200  0.1                0.5           0.83  framing error" in output

    assert main(["commtest", "list", *options]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == ["id", "2", "1"]
    assert "complete  plain    both" in listed[1]

    assert main(["commtest", "show", "1", *options]) == 0
    shown = capsys.readouterr().out
    for text in (
        "avr-g++",
        "emulated board",
        "place         emulated",
        "test's time   ",
        "/micro_cat_test/",
        "ring overrun: the sketch read too slowly",
    ):
        assert text in shown

    assert main(["commtest", "compare", "1", "2", "table6", "table5", *options]) == 0
    compared = capsys.readouterr().out.splitlines()
    header = ["1", "2", "difference", "table6", "difference", "table5", "difference"]
    assert compared[0].split()[-7:] == header
    assert compared[2].split() == ["115200", "0.1", "0.5", "0.83", "1.00", "+0.17", "0.96", "+0.13", "-", "-"]

    assert main(["commtest", "export", "1", *options]) == 0
    first, second = csv.DictReader(io.StringIO(capsys.readouterr().out))
    assert (first["run"], first["framing"], first["pi_delay"], second["pi_delay"]) == (
        "1",
        "thesis",
        "0.0",
        "0.5",
    )
    assert float(second["rate"]) == int(second["right"]) / 12 == 10 / 12
    assert int(first["bytes_read"]) + int(first["bytes_lost"]) == 12 * 9

    assert main(["commtest", "export", "2", "--format", "json", *options]) == 0
    exported = json.loads(capsys.readouterr().out)
    assert exported["document"]["expected"] == 12
    assert exported["tools"]["emulated board"]
    assert [cell["pi_delay"] for cell in exported["cells"]] == [0.0, 0.5]


def test_an_impossible_request_is_refused_with_the_reason(
    options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = write(tmp_path, ENTRY | {"delay": [-1], "speed": 3})
    for arguments, text in (
        (["run", document], "test 1: 'speed' is not known here"),
        (["run", document], "test 1: delay[0] is -1; it must lie between 0 and 10"),
        (["run", str(tmp_path / "none.json")], "none.json cannot be read"),
        (["show", "7"], "There is no run 7"),
        (["export", "7"], "There is no run 7"),
        (["compare", "table6", "table7"], "'table7' is neither the number of a run"),
    ):
        assert main(["commtest", *arguments, *options]) == 1
        assert text in capsys.readouterr().err
    assert main(["commtest", "list", *options]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1


def test_beside_a_running_server_the_command_refers_to_the_page(
    settings: Settings, options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = write(tmp_path, ENTRY)
    with settings.data.lock.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert main(["commtest", "run", document, *options]) == 1
        assert "start the test from its page" in capsys.readouterr().err
    assert main(["commtest", "run", document, "--place", "robot", *options]) == 1
    assert "runs only while the server does" in capsys.readouterr().err


def test_a_damaged_database_is_reported(
    settings: Settings, options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    settings.data.database.write_bytes(b"nonsense" * 1000)
    assert main(["commtest", "list", *options]) == 1
    assert "cannot be used: file is not a database" in capsys.readouterr().err


def test_the_cells_of_an_interrupted_run_stay_stored(
    settings: Settings, options: list[str], tmp_path: Path
) -> None:
    # From the third cell on each takes a while, so that the interruption does not come after the last one.
    delays = [0.0, 0.01, *(9 + number / 100 for number in range(98))]
    document = write(tmp_path, ENTRY | {"delay": delays, "arduinodelay": [0]})
    command = [sys.executable, "-m", "server.cli", "commtest", "run", document, *options]
    # In a group of its own, so that the interruption reaches the emulated board too, as from a terminal.
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert process.stdout is not None
        assert next(line for line in process.stdout if line.startswith("[  2/100]"))
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=SECONDS)
    assert (process.returncode, "was cancelled" in errors, "Traceback" in errors) == (1, True, False)
    with closing(Store(settings.data.database)) as store:
        (run,) = CommTestStore(store).list()
        cells = CommTestStore(store).cells(1)
    assert run.state == "cancelled"
    assert run.ended is not None
    assert 2 <= len(cells) < 100
    assert [cell.number for cell in cells] == list(range(len(cells)))


async def test_a_killed_run_is_not_listed_as_running(store: Store) -> None:
    runs = CommTestStore(store)

    killed = await begin(runs)
    await runs.mark_interrupted()
    other = await begin(runs)
    newest, oldest = runs.summaries()
    assert [(newest.id, newest.state), (oldest.id, oldest.state)] == [
        (other, "running"),
        (killed, "interrupted"),
    ]
    assert oldest.problem


async def test_the_newest_runs_are_listed(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("server.features.comm_tests.runs.LISTED_MOST", 2)
    runs = CommTestStore(store)

    for _ in range(3):
        await runs.add(await begin(runs), 0, LOST.values)
    assert [(summary.id, summary.cells_done) for summary in runs.summaries()] == [(3, 1), (2, 1)]


async def test_a_lost_result_is_stored_as_lost(store: Store) -> None:
    runs = CommTestStore(store)

    number = await begin(runs)
    await runs.add(number, 0, LOST.values)
    (stored,) = runs.cells(number)
    assert (stored.rate, stored.answered, stored.line_errors) == (0.0, False, 7)
    assert stored.causes == "lost result, line"
    run = runs.find(number)
    assert "9600 baud, Arduino 0.5 s, Pi 1 s: lost result" in tables.show_run(run, [stored])
    whole = runs.whole(run)
    assert (whole.cells_done, whole.rate_mean, whole.rate_min) == (1, 0.0, 0.0)
    assert whole.results[0].causes == ["lost result", "line"]


async def test_an_invalid_cell_is_not_stored(store: Store) -> None:
    runs = CommTestStore(store)

    number = await begin(runs)
    with pytest.raises(ValueError, match="rate"):
        await runs.add(number, 0, {"baud": 9600, "rate": "all"})
    assert runs.cells(1) == []


def test_runs_of_the_previous_version_are_still_there(settings: Settings) -> None:
    upgrade_to(settings, "0002")
    with closing(sqlite3.connect(settings.data.database)) as database:
        columns = "name, document, framing, direction, cells, firmware, tools, host, started, state, problem"
        values = "'old', '{}', 'thesis', 'to_board', 1, 'f', '{}', 'h', 1.0, 'complete', ''"
        database.execute(f"INSERT INTO comm_test_run ({columns}) VALUES ({values})")
        database.commit()
    with new_store(settings.data) as store:
        (run,) = CommTestStore(store).summaries()
    assert (run.name, run.place, run.sample) == ("old", "emulated", "")


def test_samples_are_imported_once_and_a_damaged_one_is_skipped(
    store: Store, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    runs = CommTestStore(store)
    good = {
        "id": 7,
        "name": "kept",
        "framing": "plain",
        "direction": "both",
        "firmware": "f",
        "host": "h",
        "document": {"id": 1},
        "tools": {"compiler": "c"},
        "started": 1.0,
        "ended": 2.0,
        "state": "complete",
        "problem": "",
        "cells": [{"number": 0, **LOST.values}],
    }
    (tmp_path / "good.json").write_text(json.dumps(good), encoding="utf-8")
    (tmp_path / "cut.json").write_text('{"name": ', encoding="utf-8")
    (tmp_path / "list.json").write_text("[]", encoding="utf-8")
    (tmp_path / "empty.json").write_text(json.dumps(good | {"cells": [{}]}), encoding="utf-8")
    for _ in range(2):
        asyncio.run(import_samples(runs, tmp_path))
    (run,) = runs.summaries()
    assert (run.sample, run.name, run.cells, run.cells_done) == ("good", "kept", 1, 1)
    for name in ("cut", "list", "empty"):
        assert f"{name}.json cannot be read" in caplog.text


def test_the_shipped_documents_are_valid(store: Store) -> None:
    first, *others = shipped_documents()
    assert (first.name, first.text) == ("figure10", THESIS.read_text(encoding="utf-8"))
    assert {document.name for document in others} >= {"plain", "robot", "both-ways", "noisy-line", "quick"}
    for document in (first, *others):
        assert read_document(document.text)
    runs = CommTestStore(store)
    asyncio.run(import_samples(runs))
    shipped = (file.name for file in (files("server.features.comm_tests") / "samples").iterdir())
    names = {name.removesuffix(".json") for name in shipped if name.endswith(".json")}
    assert "grid-robot-both" in names
    assert {run.sample for run in runs.summaries()} == names
    assert all(run.cells == run.cells_done for run in runs.summaries())


def test_the_tables_of_the_thesis_are_complete() -> None:
    table5, table6 = read_table("table5"), read_table("table6")
    assert len(table5) == 15
    assert len(table6) == 75
    assert table5[115200, 0.0, 0.0] == 0.94
    assert table6[4800, 1.0, 0.5] == 0.57
    assert {position for position in table6 if position[1] == 0} == set(table5)
