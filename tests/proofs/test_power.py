"""A short version of `make power`, and a check that one connection writes the database."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.proofs import disk
from tests.proofs.disk import DiskStep, LoggedDisk
from tests.proofs.power import MEMORY, WEAKER, is_whole, record, replay

Recorded = tuple[Path, LoggedDisk, list[DiskStep]]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return disk.build(tmp_path_factory.mktemp("library"))


@pytest.fixture
def folder() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="mucat-", dir=MEMORY) as name:
        yield Path(name)


@pytest.fixture(scope="module")
def recorded(library: Path) -> Iterator[Recorded]:
    with tempfile.TemporaryDirectory(prefix="mucat-", dir=MEMORY) as name:
        yield record(Path(name), library)


def test_committed_changes_survive_a_power_cut(recorded: Recorded) -> None:
    data, before, steps = recorded
    report = replay(data, before, steps, states=300, seed=1)
    assert (report.cuts.total(), report.bad, report.words) == (300, 0, [])
    assert report.facts > 300
    assert is_whole(data, before)


@pytest.mark.parametrize("name", WEAKER)
def test_weaker_settings_lose_data(name: str, library: Path, folder: Path) -> None:
    report = replay(*record(folder, library, *WEAKER[name]), states=180, seed=1)
    assert report.lossy.total() > 0


def test_one_connection_writes_the_database(recorded: Recorded) -> None:
    """Only one connection writes, during an export and beside shell commands that list and back up."""
    data, _, steps = recorded
    prepared = [index for index, step in enumerate(steps) if step.kind == "a"][1]
    nodes: dict[int, str] = {}
    writers: dict[str, set[tuple[int, int]]] = {}
    processes = set()
    for position, step in enumerate(steps):
        if step.kind == "c":
            nodes[step.node] = step.name
        elif position > prepared and step.kind == "w":
            processes.add(step.process)
            writers.setdefault(nodes[step.node], set()).add((step.process, step.handle))
    assert [len(writers[f"{data}/mucat.db{end}"]) for end in ("", "-wal")] == [1, 1]
    assert f"{data}/mucat.db-journal" not in writers
    assert len(processes) > 1  # the export's own
