"""A data folder of version 0.1.0: its database opens, and its contents are read as they were.

`expected.json` is what 0.1.0 itself answered: SHA-256 of every exported CSV, timelines, figures and lines.
"""

import asyncio
import csv
import gzip
import hashlib
import io
import json
import zipfile
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.transport.blocks import read_blocks
from server.cli import main
from server.features.exports.archive_reader import examine
from server.platform.settings import Settings
from tests.server.serving import serve

FOLDER = Path(__file__).parents[1] / "data/0.1.0"
EXPECTED: dict[str, Any] = json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))
SESSIONS = ("1", "2", "3")
"""A live dive with a tuning run in it, a dive by hand, and the scenario of the thesis's Figure 14."""

STRETCH = 10
"""s that are replayed at a time."""


@pytest.fixture
def released(settings: Settings) -> Settings:
    settings.data.database.write_bytes(gzip.decompress((FOLDER / "mucat.db.gz").read_bytes()))
    return settings


def read_csv(settings: Settings, session: str, folder: Path) -> dict[str, bytes]:
    """Return the exported tables and pictures of a session, by file name."""
    path = folder / f"{session}.zip"
    where = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert main(["export", session, "--format", "csv", "-o", str(path), *where]) == 0
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if name != "session.json"}


def ask(settings: Settings, method: str, path: str, **options: Any) -> Any:
    """Return the answer of a server that serves this folder."""

    async def run() -> Any:
        async with serve(settings) as served:
            return (await served.api.request(method, path, **options)).raise_for_status().json()

    return asyncio.run(run())


@pytest.mark.parametrize("session", SESSIONS)
def test_exported_tables_are_identical(released: Settings, session: str, tmp_path: Path) -> None:
    files = read_csv(released, session, tmp_path)
    assert {name: hashlib.sha256(data).hexdigest() for name, data in files.items()} == EXPECTED["csv"][
        session
    ]


@pytest.mark.parametrize("session", SESSIONS)
def test_an_archive_is_read_as_one_of_today(released: Settings, session: str, tmp_path: Path) -> None:
    path = tmp_path / "dive.mucat.zip"
    where = ["--data", str(released.data.path), "--config", str(released.config)]
    assert main(["export", session, "--format", "archive", "-o", str(path), *where]) == 0
    examine(path, tmp_path / "rows")


def test_comparisons_give_the_same_figures(released: Settings) -> None:
    request = {"sessions": [1, 3], "signals": ["depth.depth", "control.set_point"], "align": {"by": "armed"}}
    answer = ask(released, "POST", "/compare", json={**request, "points": 200})
    sessions = answer["sessions"]
    # Each figure of then; later versions have more.
    figures = [
        {name: session["figures"][name]["value"] for name in expected}
        for session, expected in zip(sessions, EXPECTED["figures"], strict=True)
    ]
    assert figures == [pytest.approx(expected) for expected in EXPECTED["figures"]]
    assert [session["series"] for session in sessions] == EXPECTED["series"]


@pytest.mark.parametrize("session", SESSIONS)
def test_the_timeline_is_the_same(released: Settings, session: str) -> None:
    timeline = ask(released, "GET", f"/sessions/{session}/timeline")
    # Newer versions answer with the first line of a bookmark's note, too: all that there was of it in 0.1.0.
    assert [marker.pop("name") for marker in timeline["markers"]] == [
        marker["text"] for marker in timeline["markers"]
    ]
    assert timeline.pop("filmed") is False
    assert timeline == EXPECTED["timeline"][session]


@pytest.mark.parametrize("session", SESSIONS)
def test_a_replay_carries_every_sample(released: Settings, session: str, tmp_path: Path) -> None:
    recorded = {
        name.removesuffix(".csv"): len(list(csv.reader(io.StringIO(data.decode())))) - 1
        for name, data in read_csv(released, session, tmp_path).items()
        if name.endswith(".csv")
    }

    async def play() -> tuple[Counter[str], set[str]]:
        counts: Counter[str] = Counter()
        left_out: set[str] = set()
        async with serve(released) as served:
            for start in range(-STRETCH, 120, STRETCH):
                stretch = {"start": start, "end": start + STRETCH}
                answer = await served.api.get(f"/sessions/{session}/blocks", params=stretch)
                left_out.add(answer.raise_for_status().headers["Left-Out"])
                for block in read_blocks(answer.content):
                    counts[block.topic.name] += block.count
        return counts, left_out

    replayed, left_out = asyncio.run(play())
    assert left_out == {"0"}
    assert {name: replayed[name] for name in recorded} == recorded


def test_everything_else_in_the_folder_is_still_there(released: Settings) -> None:
    async def run() -> list[Any]:
        async with serve(released) as served:
            paths = ("/comm-tests/runs", "/tuning/runs", "/profiles", "/parameters/changes")
            return [(await served.api.get(path)).raise_for_status().json() for path in paths]

    tests, tuning, profiles, changes = asyncio.run(run())
    assert "A quick look: three bauds over the robot's own link" in [test["name"] for test in tests]
    assert [run["name"] for run in tuning["runs"]] == ["PID, 0.4 m to 0.7 m"]
    assert [(profile["name"], profile["values"]["control.set_point"]) for profile in profiles] == [
        ("calm water", 0.4)
    ]
    assert [change["values"] for change in changes] == [
        [{"name": "vision.rate", "before": 4.0, "after": 5.0}],
        [{"name": "control.set_point", "before": 0.5, "after": 0.4}],
        [{"name": "depth.controller", "before": "bang_bang", "after": "pid"}],
    ]
