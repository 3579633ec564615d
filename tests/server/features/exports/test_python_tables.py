"""One session gives the same tables in Python from the data folder and from every file."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas
import pytest

from mucat import FolderSessions, RobotError, Sessions, SessionTables
from robot_runtime.contract.documents import Control, Event
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents
from server.features.exports.formats import KINDS
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, state_block
from tests.server.features.doors.rig import imu, rows_block
from tests.server.features.exports.recordings import record
from tests.server.features.exports.test_imports import repack

FILES = ("csv", "mcap", "archive")


@pytest.fixture
def session(store: Store, settings: Settings) -> int:
    return record_every_kind(store, settings)


def record_every_kind(store: Store, settings: Settings) -> int:
    """Rows with numbers of every kind, NaN among them, lines of text and a document of everything."""
    alarm = Event(time=100.25, kind="leak", severity="alarm", text="water in the hull")
    latencies = (0.01, math.nan, math.inf)
    ticks = [
        Control(set_point=0.5, depth=0.25, error=0.25, output=-1, latency=latency) for latency in latencies
    ]
    return record(
        store,
        settings,
        [
            depth_block(0, 50),
            rows_block("imu", 0, (100.0, imu((0.6, 0.8, 0, 0))), (100.01, imu((1, 0, 0, 0)))),
        ],
        [
            depth_block(50, 50),
            rows_block("control", 0, *((100 + index / 10, tick) for index, tick in enumerate(ticks))),
            debug_block(0, "12", "it's wet"),
            state_block(0),
            Block.of(BY_NAME["event"], 1, 0, pack_documents([alarm])),
        ],
    )


@pytest.fixture
def write(store: Store, session: int, tmp_path: Path) -> Callable[[Any], Path]:
    def write_file(kind: Any) -> Path:
        path = tmp_path / f"dive.{kind}"
        source = ExportSelection(store, find_row(store, session), ExportOptions(format=kind))
        with path.open("wb") as output:
            KINDS[source.options.format].write(store, source, output)
        return path

    return write_file


@pytest.mark.parametrize("kind", FILES)
def test_a_file_gives_the_tables_of_the_data_folder(
    settings: Settings, session: int, write: Callable[[Any], Path], kind: str
) -> None:
    stored = FolderSessions(settings.data.path).load(session)
    exported = Sessions.read(write(kind))
    assert (
        set(exported.topics) == set(stored.topics) >= {"depth", "imu", "control", "state", "debug", "event"}
    )
    for name in ("identifier", "name", "robot", "version", "configuration"):
        assert exported.about[name] == stored.about[name]
    for topic in stored.topics:
        first, other = stored.pandas(topic), exported.pandas(topic)
        assert stored.units(topic) == exported.units(topic)
        # JSON has no infinity.
        if kind == "mcap":
            first = first.replace(math.inf, math.nan)
        pandas.testing.assert_frame_equal(first, other, rtol=1e-9, check_dtype=False, check_like=True)
        assert exported.polars(topic).columns == [*other]


def test_units_and_numbers_are_those_of_the_robot(settings: Settings, session: int) -> None:
    tables = FolderSessions(settings.data.path).load(session)
    assert tables.units("depth") == {
        "time": "s",
        "board_time": "s",
        "depth": "m",
        "pressure": "Pa",
        "temperature": "°C",
    }
    depth = tables.pandas("depth")
    assert depth["depth"].tolist() == [count * 0.001 for count in range(100)]
    assert depth["time"][0] == 0.5
    assert tables.pandas("imu")["attitude_1"].tolist() == pytest.approx([0.8, 0], abs=1e-4)
    assert tables.pandas("debug")["text"].tolist() == ["12", "it's wet"]
    (listed,) = FolderSessions(settings.data.path).list()
    assert (listed["id"], listed["state"]) == (session, "complete")


def test_what_is_damaged_or_not_there_is_named(
    settings: Settings, write: Callable[[Any], Path], tmp_path: Path
) -> None:
    with pytest.raises(RobotError, match="no data folder"):
        FolderSessions(tmp_path / "nowhere").list()
    with pytest.raises(RobotError, match="has no session 99"):
        FolderSessions(settings.data.path).load(99)
    archive = write("archive")
    whole = archive.read_bytes()
    # The first chunk's first bytes, after the name of its member.
    at = whole.index(b"chunks/imu") + len(b"chunks/imu") + 60
    archive.write_bytes(whole[:at] + bytes(20) + whole[at + 20 :])
    with pytest.raises(RobotError, match="topic imu is damaged"):
        Sessions.read(archive).pandas("imu")
    film = write("mcap")
    film.write_bytes(film.read_bytes()[:-40])
    with pytest.raises(RobotError, match="cannot be read"):
        Sessions.read(film)
    with pytest.raises(RobotError, match="has no topic height"):
        Sessions.read(write("csv")).units("height")


def test_a_session_of_an_older_version_is_read(tmp_path: Path) -> None:
    released = Path(__file__).parents[3] / "data" / "0.2.0" / "session.mucat.zip"
    tables: SessionTables = Sessions.read(released)
    assert tables.about["version"].startswith("0.2.0")
    depth = tables.pandas("depth")
    assert 0.2 < depth["depth"].max() < 1.5
    assert depth["time"].is_monotonic_increasing
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("kind", ["csv", "archive"])
def test_a_file_that_was_packed_again_is_read(write: Callable[[Any], Path], kind: str) -> None:
    path = write(kind)
    known, packed = Sessions.read(path), Sessions.read(repack(path, "dive/"))
    assert packed.topics == known.topics
    pandas.testing.assert_frame_equal(packed.pandas("depth"), known.pandas("depth"))
