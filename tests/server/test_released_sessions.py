"""The session of every released version is replayed, compared and exported as that version itself did it.

`make released-session` has stored them (tests/released.py); test_released_data.py does the same for the data
folder of 0.1.0, which had no archives.
"""

import asyncio
import json
import re
import shutil
from collections import Counter
from pathlib import Path

import pytest

from robot_runtime.transport.blocks import read_blocks
from server.features.exports.imports import Imports
from server.library.content import Recording
from server.library.replay import RANGE_MAX, read_blocks_between
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.released import ARCHIVE, DATA, DATA_EXPECTED, EXPECTED, RELEASED, compare, hash_tables
from tests.stack import ROOT

FOLDERS = sorted(path.parent for path in RELEASED.glob(f"*/{ARCHIVE}"))
FULL_FOLDERS = sorted(path.parent for path in RELEASED.glob(f"*/{DATA}"))


@pytest.fixture(params=FOLDERS, ids=lambda folder: folder.name)
def released(request: pytest.FixtureRequest) -> Path:
    folder: Path = request.param
    return folder


def take(settings: Settings, store: Store, folder: Path) -> int:
    return asyncio.run(Imports(settings.data, store).take(folder / ARCHIVE))


def test_every_released_version_has_a_session() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.findall(r"^## \[(\d+\.\d+\.\d+)\]", changelog, re.MULTILINE)
    assert len(versions) >= 2
    assert {"0.1.0", *(folder.name for folder in FOLDERS)} == set(versions)


@pytest.mark.parametrize("version", [None, "0.0.9"])
def test_a_session_of_another_version_is_replayed_with_every_sample(
    settings: Settings, store: Store, released: Path, version: str | None
) -> None:
    row = find_row(store, take(settings, store, released))
    row.version = version or row.version
    recording = Recording(store, row)
    start = row.started_steady - 1
    replayed = read_blocks_between(recording, start, start + RANGE_MAX)
    counts = Counter[str]()
    for block in read_blocks(replayed.data):
        counts["thumbnail" if block.topic.name == "picture" else block.topic.name] += block.count
    assert replayed.left_out == 0
    assert counts == recording.counts()


def test_a_session_of_another_version_is_compared_and_exported_as_by_its_own(
    settings: Settings, store: Store, released: Path
) -> None:
    number = take(settings, store, released)
    expected = json.loads((released / EXPECTED).read_text(encoding="utf-8"))
    assert hash_tables(settings.data.path, number) == expected["tables"]
    compared = compare(settings.data.path, number)
    # Each figure of then; later versions have more.
    figures = expected["comparison"]["figures"]
    assert {name: compared["figures"][name] for name in figures} == pytest.approx(figures)
    assert compared["lines"] == expected["comparison"]["lines"]


@pytest.mark.parametrize("folder", FULL_FOLDERS, ids=lambda folder: folder.name)
def test_a_data_folder_of_another_version_is_upgraded_and_read(settings: Settings, folder: Path) -> None:
    shutil.unpack_archive(folder / DATA, settings.data.path)
    expected = json.loads((folder / DATA_EXPECTED).read_text(encoding="utf-8"))
    assert hash_tables(settings.data.path, 1) == expected
