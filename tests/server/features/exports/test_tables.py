import asyncio
import csv
import io
import json
import struct
import zipfile
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any, BinaryIO, cast

import pytest
from sqlalchemy import Connection, text

from robot_runtime.contract.documents import Truth
from robot_runtime.contract.packets import Motor
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, read_rows, row
from server.features.exports.description import file_name
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.features.exports.tables import write_tables
from server.library.content import CHUNKS_AT_ONCE, RecordingError
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, state_block
from tests.server.features.exports.recordings import STARTED_STEADY, record


def make(store: Store, session: int, **expected: Any) -> ExportSelection:
    row = find_row(store, session)
    return ExportSelection(store, row, ExportOptions(**{"format": "csv", **expected}))


def unpack(store: Store, source: ExportSelection) -> zipfile.ZipFile:
    output = io.BytesIO()
    write_tables(store, source, output)
    archive = zipfile.ZipFile(output)
    assert archive.testzip() is None
    return archive


def table(archive: zipfile.ZipFile, name: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(archive.read(f"{name}.csv").decode())))


@pytest.mark.parametrize("text", ['=HYPERLINK("http://x")', "+1", "-1", "@SUM(1)", "\t=1", "\r=1", "＝1"])
def test_a_text_is_no_formula_for_a_spreadsheet(store: Store, settings: Settings, text: str) -> None:
    session = record(store, settings, [debug_block(0, text, f"a{text}")])
    read = table(unpack(store, make(store, session)), "debug")
    shown = text.replace("\r", "\n")
    assert [line["text"] for line in read] == [f"'{shown}", f"a{shown}"]


def test_exported_numbers_equal_the_recorded_ones(store: Store, settings: Settings) -> None:
    motor = Motor(
        time=2**32 - 1, wanted=(0.1, -0.2, 3.1, 0), angle=(1.234, 0, 0, -3.2), drive=(-63, 63, 0, 5)
    )
    truth = Truth(
        position=(0.1, 1 / 3, 1e-9),
        attitude=(1, 0, 0, 0),
        velocity=(1e20, -0.0, 3),
        rate=(0, 0, 0),
        fins=(0.7, 0, 0, 0),
    )
    blocks = [
        Block.of(BY_NAME["motor"], 1, 0, row(100.25, motor.to_bytes())),
        Block.of(BY_NAME["truth"], 1, 0, row(100.5, truth.to_bytes())),
        depth_block(0, 30),
    ]
    archive = unpack(store, make(store, record(store, settings, blocks)))
    (line,) = table(archive, "motor")
    (_, sent), *_ = read_rows(blocks[0])
    assert isinstance(sent, Motor)
    assert [float(line[f"angle_{fin} [rad]"]) for fin in range(4)] == list(sent.angle)
    assert [int(line[f"drive_{fin}"]) for fin in range(4)] == list(sent.drive)
    assert (line["time [µs]"], float(line["time [s]"])) == ("4294967295", 0.75)
    (line,) = table(archive, "truth")
    single = [struct.unpack("<f", struct.pack("<f", value))[0] for value in truth.position + truth.velocity]
    columns = [f"position_{axis} [m]" for axis in range(3)] + [f"velocity_{axis} [m/s]" for axis in range(3)]
    assert [struct.pack("<f", float(line[column])) for column in columns] == [
        struct.pack("<f", value) for value in single
    ]
    lines = table(archive, "depth")
    assert [int(line["time [µs]"]) for line in lines] == list(range(30))
    assert [float(line["depth [m]"]) for line in lines] == pytest.approx(
        [n / 1000 for n in range(30)], abs=1e-12
    )
    assert [int(line["pressure [Pa]"]) for line in lines] == [101_325 + n for n in range(30)]


def test_the_header_gives_units_and_two_times(store: Store, settings: Settings) -> None:
    source = make(store, record(store, settings, [depth_block(0, 1)]))
    (line,) = table(unpack(store, source), "depth")
    assert list(line) == ["time [s]", "utc", "time [µs]", "depth [m]", "pressure [Pa]", "temperature [°C]"]
    started = source.row.started
    assert float(line["time [s]"]) == 100 - STARTED_STEADY
    utc = datetime.fromisoformat(line["utc"])
    assert utc.timestamp() == pytest.approx(started + 0.5, abs=0.001)
    assert line["utc"].endswith("Z")


def test_documents_are_tables_too(store: Store, settings: Settings) -> None:
    awkward = 'say "hi", then\nbreak; é'
    archive = unpack(
        store, make(store, record(store, settings, [debug_block(0, awkward, "b"), state_block(0)]))
    )
    assert [(line["level"], line["text"]) for line in table(archive, "debug")] == [("1", awkward), ("1", "b")]
    (state,) = table(archive, "state")
    assert (state["armed"], state["armed_since"], state["port"]) == ("false", "", "board.tty")
    assert json.loads(state["colours"]) == ["yellow"]


def test_each_chunk_is_exported_once_and_in_order(store: Store, settings: Settings) -> None:
    batches = [[depth_block(3 * number, 3)] for number in range(CHUNKS_AT_ONCE * 2 + 1)]
    archive = unpack(store, make(store, record(store, settings, *batches)))
    numbers = [int(line["time [µs]"]) for line in table(archive, "depth")]
    assert numbers == list(range(3 * len(batches)))


def test_an_export_holds_the_recorded_topics_and_the_session_s_description(
    store: Store, settings: Settings
) -> None:
    session = record(store, settings, [depth_block(0, 1), depth_block(5, 1)])
    archive = unpack(store, make(store, session))
    assert set(archive.namelist()) == {"session.json", "depth.csv"}
    message: dict[str, Any] = json.loads(archive.read("session.json"))
    assert (message["id"], message["note"], message["state"]) == (session, "calm", "complete")
    assert message["configuration"] == settings.config.read_text()
    assert message["robot_state"] == {"mode": "disarmed"}
    assert message["gaps"] == [{"topic": "depth", "kind": "missed", "time": 0.0, "missed": 4}]
    assert message["topics"]["depth"]["fields"][1]["unit"] == "m"
    assert datetime.fromisoformat(message["started"]).tzinfo == UTC


def test_a_recording_is_read_by_its_own_definitions(store: Store, settings: Settings) -> None:
    session = record(store, settings, [depth_block(0, 2)])

    def rename(connection: Connection) -> None:
        connection.execute(text("UPDATE session SET topics = replace(topics, 'temperature', 'warmth')"))

    asyncio.run(store.write(rename))
    assert "warmth [°C]" in table(unpack(store, make(store, session)), "depth")[0]


def test_the_file_is_streamed_and_never_whole_in_memory(store: Store, settings: Settings) -> None:
    batches = [[depth_block(1000 * number, 1000)] for number in range(CHUNKS_AT_ONCE * 4)]
    source = make(store, record(store, settings, *batches))
    pieces: list[int] = []
    write_tables(
        store, source, cast("BinaryIO", SimpleNamespace(write=lambda data: pieces.append(len(data))))
    )
    assert len(pieces) > 10
    assert max(pieces) < 0.2 * sum(pieces)


def test_the_file_name_is_safe(store: Store, settings: Settings) -> None:
    name = file_name(make(store, record(store, settings)), ".zip")
    assert name.endswith("_Dive-no-1-resund-x.zip")
    datetime.strptime(name[:19], "%Y-%m-%d_%H-%M-%S")


def test_a_damaged_chunk_is_reported(store: Store, settings: Settings) -> None:
    session = record(store, settings, [depth_block(0, 2)])
    asyncio.run(store.write(lambda connection: connection.execute(text("UPDATE chunk SET data = x'00'"))))
    with pytest.raises(RecordingError, match="chunk 0 of depth is damaged"):
        unpack(store, make(store, session))
