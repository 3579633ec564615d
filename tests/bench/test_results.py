"""The file of figures: where each comes from, and what becomes of a part that fails."""

import json
import subprocess
from pathlib import Path

import pytest

from bench.results import PROOFS, Results, commit


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "build/bench.json"


def test_a_figure_carries_its_date_commit_machine_and_calibration(file: Path) -> None:
    Results(file).add("page", {"page.redraw_ms": 7.5}, {"drawing": 1.2})
    figure = Results(file).figures["page.redraw_ms"]
    assert (figure.value, figure.part, figure.slowness) == (7.5, "page", {"drawing": 1.2})
    assert figure.commit == commit()
    assert "cores" in figure.machine
    assert figure.measured.endswith("+00:00")


def test_figures_are_in_the_file_as_soon_as_their_part_is_measured(file: Path) -> None:
    results = Results(file)
    results.add("store", {"store.ingest_ratio": 90.0}, {})
    assert list(json.loads(file.read_text())["figures"]) == ["store.ingest_ratio"]


def test_a_part_that_fails_has_no_figures_of_earlier_times(file: Path) -> None:
    results = Results(file)
    results.add("stack", {"rss.server_mb": 100.0}, {})
    results.add("start", {"start.ready_s": 3.0}, {})
    results.fail("stack", "2 processes instead of one")
    stored = Results(file)
    assert list(stored.figures) == ["start.ready_s"]
    assert stored.failures["stack"].reason == "2 processes instead of one"


def test_a_part_that_is_measured_again_has_failed_no_more(file: Path) -> None:
    results = Results(file)
    results.fail("stack", "no server")
    results.add("stack", {"rss.server_mb": 100.0}, {})
    assert Results(file).failures == {}


def test_a_figure_that_a_part_no_longer_returns_is_removed(file: Path) -> None:
    results = Results(file)
    results.add("page", {"page.fps": 60.0}, {})
    results.add("page", {"page.redraw_ms": 8.0}, {})
    assert list(Results(file).figures) == ["page.redraw_ms"]


def test_a_flat_file_of_earlier_versions_counts_as_empty(file: Path) -> None:
    file.parent.mkdir()
    file.write_text('{"page.fps": 60.0}')
    assert Results(file).figures == {}


def test_a_stored_table_of_a_proof_changes_no_commit_and_code_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert commit() == "unknown"
    table, code = tmp_path / PROOFS / "control.md", tmp_path / "code.py"
    table.parent.mkdir(parents=True)
    for file in (table, code):
        file.write_text("1")
    author = ("-c", "user.name=anybody", "-c", "user.email=anybody@localhost")
    for words in (("init", "--quiet"), ("add", "."), (*author, "commit", "--quiet", "--message", "all")):
        subprocess.run(["git", *words], check=True)
    clean = commit()
    table.write_text("2")
    assert commit() == clean
    code.write_text("2")
    assert commit() == f"{clean}+"
