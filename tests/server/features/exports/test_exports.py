"""Each export format, read back with its usual library."""

import asyncio
import base64
import io
import json
import math
import re
import struct
import sys
import zipfile
from pathlib import Path
from typing import Any

import pandas
import pyarrow.parquet
import pytest
from mcap.reader import make_reader
from sqlalchemy import insert

from robot_runtime.contract.documents import Control, Event, Truth
from robot_runtime.contract.packets import Imu
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents, row
from server.features.exports import grid
from server.features.exports.archive_reader import examine
from server.features.exports.formats import KINDS, check
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.interchange.mcap_schemas import WELL_KNOWN
from server.platform.models import BookmarkRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, snapshot_block, state_block
from tests.server.features.exports.recordings import record
from tests.server.library.missions import TEXT, mission_blocks

AWKWARD = 'say "hi", then\nbreak; é, nan'


def rows_block(topic: str, period: float, *records: Record) -> Block:
    rows = b"".join(row(100 + period * index, record.to_bytes()) for index, record in enumerate(records))
    return Block.of(BY_NAME[topic], len(records), 0, rows)


def imu(number: int) -> Imu:
    return Imu(time=number, attitude=(1, 0, 0, 0), rate=(0, 0, 0), force=(0, 0, -9.8))


def truth(depth: float) -> Truth:
    return Truth(
        position=(1, 2, depth),
        attitude=(1, 0, 0, 0),
        velocity=(0, 0, 0),
        rate=(0, 0, 0),
        fins=(0, 0, 0, 0),
    )


def control(latency: float) -> Control:
    return Control(set_point=0.5, depth=0.25, error=0.25, output=-1, latency=latency)


@pytest.fixture
def session(store: Store, settings: Settings) -> int:
    """Two seconds with every kind of topic, and a bookmark."""
    alarm = Event(time=100.25, kind="leak", severity="alarm", text="water in the hull")
    number = record(
        store,
        settings,
        [
            depth_block(0, 50),
            rows_block("imu", 0.01, *map(imu, range(100))),
            rows_block("truth", 0.05, *(truth(position / 10) for position in range(20))),
        ],
        [
            depth_block(50, 50),
            rows_block("control", 0.1, control(0.01), control(math.nan), control(math.inf)),
            debug_block(0, AWKWARD, "b"),
            state_block(0),
            Block.of(BY_NAME["event"], 1, 0, pack_documents([alarm])),
        ],
    )
    marker = {"session_id": number, "time": 100.5, "text": "here it turned", "made": 1.0}
    asyncio.run(store.write(lambda connection: connection.execute(insert(BookmarkRow).values(marker))))
    return number


def write(store: Store, session: int, **expected: Any) -> io.BytesIO:
    row = find_row(store, session)
    chosen, output = ExportOptions(**expected), io.BytesIO()
    check(chosen).write(store, ExportSelection(store, row, chosen), output)
    output.seek(0)
    return output


def test_parquet_keeps_numbers_types_and_units(store: Store, session: int) -> None:
    archive = zipfile.ZipFile(write(store, session, format="parquet"))
    tables = {
        name.removesuffix(".parquet"): pyarrow.parquet.read_table(io.BytesIO(archive.read(name)))
        for name in archive.namelist()
        if name.endswith(".parquet")
    }
    assert {name: table.num_rows for name, table in tables.items()} == {
        "imu": 100,
        "depth": 100,
        "control": 3,
        "truth": 20,
        "state": 1,
        "debug": 2,
        "event": 1,
    }
    depth = tables["depth"]
    assert depth.column("pressure").to_pylist() == [101_325 + n for n in range(100)]
    assert depth.column("depth").to_pylist() == [n * 0.001 for n in range(100)]
    assert str(depth.schema.field("pressure").type) == "uint32"
    assert depth.schema.field("depth").metadata[b"unit"] == b"m"
    latency = tables["control"].column("latency").to_pylist()
    assert struct.pack("<3f", *latency) == struct.pack("<3f", 0.01, math.nan, math.inf)
    assert tables["debug"].column("text").to_pylist() == [AWKWARD, "b"]
    assert json.loads(tables["state"].column("colours").to_pylist()[0]) == ["yellow"]
    utc = pandas.Timestamp(depth.column("utc")[0].as_py())
    row = find_row(store, session)
    assert utc.timestamp() == pytest.approx(row.started + 0.5, abs=1e-5)


def test_a_mission_is_exported_with_its_document_and_every_change(store: Store, settings: Settings) -> None:
    blocks = mission_blocks()
    notices = [document for block in blocks for document in json.loads(block.payload)]
    session = record(store, settings, blocks)
    messages = [
        json.loads(message.data)
        for _, _, message in make_reader(write(store, session, format="mcap")).iter_messages(
            topics=["/mission"]
        )
    ]
    assert [document["steps"] for document in messages] == [document["steps"] for document in notices]
    assert [message["document"] for message in messages] == [TEXT, "", "", "", "", TEXT]
    parquet = zipfile.ZipFile(write(store, session, format="parquet")).read("mission.parquet")
    table = pyarrow.parquet.read_table(io.BytesIO(parquet))
    assert [json.loads(document) for document in table.column("steps").to_pylist()] == [
        document["steps"] for document in notices
    ]
    csv = zipfile.ZipFile(write(store, session, format="csv")).read("mission.csv")
    assert [json.loads(text) for text in pandas.read_csv(io.BytesIO(csv))["steps"]] == [
        document["steps"] for document in notices
    ]


def test_parquet_without_its_package_names_the_installation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(ExportRequestError, match=r"pip install mucat\[parquet\]"):
        check(ExportOptions(format="parquet"))


def test_mcap_holds_every_sample_and_the_topics_that_foxglove_panels_use(store: Store, session: int) -> None:
    reader = make_reader(write(store, session, format="mcap"), validate_crcs=True)
    summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    channels = {channel.topic: channel for channel in summary.channels.values()}
    counts = {
        topic: summary.statistics.channel_message_counts[channel.id] for topic, channel in channels.items()
    }
    row = find_row(store, session)
    stored = ExportSelection(store, row, ExportOptions(format="csv")).counts()
    assert {topic: counts[f"/{topic}"] for topic in stored} == stored
    schemas = {topic: summary.schemas[channel.schema_id] for topic, channel in channels.items()}
    assert {topic: schema.name for topic, schema in schemas.items()} == {
        **{f"/{topic}": f"mucat.{topic}" for topic in stored},
        "/log": "foxglove.Log",
        "/tf": "foxglove.FrameTransform",
        "/tf_static": "foxglove.FrameTransform",
        "/pose": "foxglove.PoseInFrame",
    }
    messages: dict[str, list[dict[str, Any]]] = {}
    last = 0
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        assert schema is not None
        report = json.loads(message.data)
        assert set(json.loads(schema.data).get("required", [])) <= set(report)
        assert message.log_time >= last
        last = message.log_time
        messages.setdefault(channel.topic, []).append(report)
    assert [message["depth"] for message in messages["/depth"]] == pytest.approx(
        [n / 1000 for n in range(100)]
    )
    assert messages["/imu"][0]["attitude"] == [1, 0, 0, 0]
    assert [message.get("latency") for message in messages["/control"]] == [pytest.approx(0.01), None, None]
    log = {message["message"]: (message["name"], message["level"]) for message in messages["/log"]}
    assert log == {
        AWKWARD: ("debug", 2),
        "b": ("debug", 2),
        "water in the hull": ("leak", 4),
        "here it turned": ("marker", 2),
    }
    assert 9 <= counts["/tf"] == counts["/pose"] <= 10
    assert messages["/tf"][0]["translation"] == {"x": 1, "y": 2, "z": 0}
    assert messages["/pose"][-1]["pose"]["position"]["z"] > 1
    about = {record.name: record.metadata for record in reader.iter_metadata()}
    assert about["session"]["identifier"] == row.identifier
    assert about["configuration"]["robot.toml"] == row.configuration
    attached = next(
        attachment for attachment in reader.iter_attachments() if attachment.name == "session.json"
    )
    assert json.loads(attached.data)["marks"][0]["text"] == "here it turned"


def test_mcap_has_schemas_that_foxglove_can_read(store: Store, session: int) -> None:
    summary = make_reader(write(store, session, format="mcap")).get_summary()
    assert summary is not None
    for schema in summary.schemas.values():
        assert schema.encoding == "jsonschema"
        _look_at(json.loads(schema.data))
    for well_known in WELL_KNOWN.values():
        _look_at(well_known)


def _look_at(schema: dict[str, Any]) -> None:
    """Check that a schema stays within the subset that Foxglove's parser reads."""
    if "oneOf" in schema:
        assert all(isinstance(option["const"], int) for option in schema["oneOf"])
        return
    assert schema["type"] in ("boolean", "string", "number", "integer", "array", "object")
    if schema["type"] == "array":
        assert schema["items"]["type"] != "array"
        _look_at(schema["items"])
    if schema["type"] == "object":
        for member in schema["properties"].values():
            _look_at(member)


def test_mcap_without_truth_has_depth_and_attitude(store: Store, settings: Settings) -> None:
    number = record(
        store, settings, [depth_block(5, 10, start=99.9), rows_block("imu", 0.05, imu(0), imu(1))]
    )
    reader = make_reader(write(store, number, format="mcap"))
    places = [json.loads(message.data) for _, _, message in reader.iter_messages(topics=["/tf"])]
    assert [position["translation"] for position in places] == [{"x": 0, "y": 0, "z": 0.007}]


def test_the_grid_has_the_newest_value_or_none(store: Store, settings: Settings) -> None:
    number = record(
        store,
        settings,
        [depth_block(0, 50), rows_block("control", 0.25, control(0.1), control(0.2))],
        [depth_block(100, 50)],
    )
    expected = ["control.latency", "depth.depth"]
    output = write(store, number, format="csv-grid", columns=expected, period=0.1, start=0.5, end=3.5)
    archive = zipfile.ZipFile(output)
    table = pandas.read_csv(archive.open("grid.csv"))
    assert list(table) == ["time [s]", "utc", "control.latency [s]", "depth.depth [m]"]
    assert len(table) == 31
    depth = table["depth.depth [m]"].tolist()
    # Samples every 0.02 s from 0.5 to 1.48 s and from 2.5 to 3.48 s; older than 0.04 s is too old.
    assert depth[:10] == pytest.approx([position * 0.005 for position in range(10)])
    assert all(map(math.isnan, depth[11:20]))
    assert depth[20:30] == pytest.approx([0.1 + position * 0.005 for position in range(10)])
    assert table["control.latency [s]"].tolist()[:9] == pytest.approx(
        [0.1] * 3 + [0.2] * 5 + [math.nan], nan_ok=True
    )
    readme = archive.read("README.txt").decode()
    assert "begins anew after 71.6 minutes" in readme
    assert "depth: 0.04 s" in readme
    assert "control: 0.5 s" in readme


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start": -5.0}, "The start, -5 s, lies outside of the session: it begins at 0 s"),
        ({"end": 99999.0}, "The end, 99999 s, lies outside of the session: it ends at 1.9 s"),
        ({"start": 3.0, "end": 4.0}, "The start, 3 s, lies outside"),
        ({"start": 1.0, "end": 1.0}, "The end, 1 s, must be after the start, 1 s"),
    ],
)
def test_a_range_outside_of_the_session_is_refused(
    store: Store, session: int, options: dict[str, Any], message: str
) -> None:
    row = find_row(store, session)
    row.duration = 1.9
    with pytest.raises(ExportRequestError, match=message):
        ExportSelection(store, row, ExportOptions(format="csv", **options))
    ExportSelection(store, row, ExportOptions(format="csv", start=0.0, end=2.0))


def test_the_grid_reports_its_progress(store: Store, session: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grid, "WINDOW_LINES", 5)
    shares: list[float] = []
    options = ExportOptions(format="csv-grid", period=0.1, start=0.0, end=1.9)
    selection = ExportSelection(store, find_row(store, session), options, shares.append)
    check(options).write(store, selection, io.BytesIO())
    assert shares == [0.25, 0.5, 0.75, 1.0]


def test_an_export_is_limited_to_its_range_and_topics(store: Store, session: int) -> None:
    chosen = {"topics": ["depth", "debug"], "start": 0.7, "end": 0.9}
    tables = zipfile.ZipFile(write(store, session, format="parquet", **chosen))
    depth = pyarrow.parquet.read_table(io.BytesIO(tables.read("depth.parquet")))
    assert depth.column("board_time").to_pylist() == pytest.approx([n * 1e-6 for n in range(10, 21)])
    archive = zipfile.ZipFile(write(store, session, format="csv", **chosen))
    assert len(archive.read("depth.csv").splitlines()) == 12


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"format": "csv", "topics": ["dephts"]}, "no topic dephts; it has imu, depth"),
        ({"format": "csv", "start": 2, "end": 1}, "must be after the start"),
        ({"format": "csv", "columns": ["depth.depth"]}, "for csv-grid alone"),
        ({"format": "csv-grid", "topics": ["depth"]}, "choose columns"),
        ({"format": "csv-grid", "columns": ["depth.dep"]}, "no column depth.dep; there are depth.time"),
        ({"format": "csv-grid", "columns": ["beacon.left"]}, "beacon has no numbers in this range"),
        ({"format": "csv-grid", "period": 0.001, "end": 1e6}, "most are 10000000"),
        ({"format": "archive", "start": 1}, "holds the whole session"),
    ],
)
def test_an_impossible_export_is_refused_with_the_reason(
    store: Store, session: int, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(ExportRequestError, match=message):
        write(store, session, **options)


# Parquet's writer and the report add the time of writing.
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in ("parquet", "report", "mp4")])
def test_the_same_session_gives_the_same_bytes(store: Store, session: int, kind: str) -> None:
    assert write(store, session, format=kind).getvalue() == write(store, session, format=kind).getvalue()


@pytest.mark.parametrize("kind", KINDS)
def test_an_empty_session_gives_a_file(store: Store, settings: Settings, kind: str) -> None:
    number = record(store, settings)
    without = {"csv-grid": "No topic has numbers", "mp4": "was not filmed then"}
    if kind in without:
        with pytest.raises(ExportRequestError, match=without[kind]):
            write(store, number, format=kind)
    else:
        write(store, number, format=kind)


def test_the_report_needs_no_network_and_names_its_figures(store: Store, session: int) -> None:
    text = write(store, session, format="report").getvalue().decode()
    assert "Plotly.newPlot" in text
    assert "RMSE" in text
    assert re.search(r"<(script|link)[^>]+(src|href)=", text) is None


def test_a_snapshot_has_its_values_beside_it(store: Store, settings: Settings) -> None:
    number = record(store, settings, [depth_block(0, 60), snapshot_block(0, 101.0, b"jpeg")])
    archive = zipfile.ZipFile(write(store, number, format="csv"))
    (jpeg, side) = (name for name in archive.namelist() if name.startswith("snapshot/"))
    assert archive.read(jpeg) == b"jpeg"
    assert side == jpeg.replace(".jpg", ".json")
    values = json.loads(archive.read(side))
    assert (values["depth"], values["heading"], values["position"]) == (pytest.approx(0.05), None, None)


def test_pictures_are_exported(store: Store, settings: Settings, tmp_path: Path) -> None:
    topic = BY_NAME["thumbnail"]
    blocks = [
        Block.of(topic, 1, position, row(100 + position, b"jpeg %d" % position)) for position in range(3)
    ]
    number = record(store, settings, [depth_block(0, 1)], blocks)
    archive = zipfile.ZipFile(write(store, number, format="csv"))
    assert archive.read("thumbnail/000001.500.jpg") == b"jpeg 1"
    tables = zipfile.ZipFile(write(store, number, format="parquet"))
    table = pyarrow.parquet.read_table(io.BytesIO(tables.read("thumbnail.parquet")))
    assert table.column("jpeg").to_pylist() == [b"jpeg 0", b"jpeg 1", b"jpeg 2"]
    reader = make_reader(write(store, number, format="mcap"))
    results = [
        (schema, json.loads(message.data)) for schema, _, message in reader.iter_messages(topics="/camera")
    ]
    assert [base64.b64decode(image["data"]) for _, image in results] == [b"jpeg 0", b"jpeg 1", b"jpeg 2"]
    schema, image = results[0]
    assert schema is not None
    assert (schema.name, image["format"]) == ("foxglove.CompressedImage", "jpeg")
    whole = tmp_path / "whole"
    whole.write_bytes(write(store, number, format="archive").getvalue())
    examine(whole, whole.with_suffix(".rows"))


def test_the_example_of_the_docs_runs(
    store: Store,
    session: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = (Path(__file__).parents[4] / "docs/use/export.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (tmp_path / "dive.zip").write_bytes(write(store, session, format="csv").getvalue())
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "docs/use/export.md", "exec"), {})
    assert "count    100.0" in capsys.readouterr().out
