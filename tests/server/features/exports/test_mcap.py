"""MCAP files, read in full by the two libraries that others read them with."""

import asyncio
import io
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest
from mcap import records
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.stream_reader import StreamReader, breakup_chunk
from sqlmodel import update

from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, row
from server.features.exports.formats import check
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.platform.models import SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, state_block
from tests.server.features.doors.rig import imu, rows_block, truth
from tests.server.features.exports.recordings import record

CLIENTS = Path(__file__).parents[3] / "clients"
COMPRESSIONS = ("none", "zstd", "lz4")
MAGIC = b"\x89MCAP0\r\n"


@pytest.fixture
def session(store: Store, settings: Settings) -> int:
    """A dive with pictures, lines of text, truth and attitude: several chunks of a megabyte."""
    level = (1.0, 0.0, 0.0, 0.0)
    pictures = [
        Block.of(BY_NAME["thumbnail"], 1, position, row(100 + position / 10, bytes(100_000)))
        for position in range(20)
    ]
    return record(
        store,
        settings,
        [
            depth_block(0, 200),
            rows_block("imu", 0, *((100 + position / 100, imu(level)) for position in range(300))),
            rows_block(
                "truth", 0, *((100 + position / 20, truth((1, 2, 3), level)) for position in range(60))
            ),
            debug_block(0, "ä", "b"),
            state_block(0),
        ],
        pictures,
    )


def write(store: Store, session: int, path: Path, **choice: Any) -> Path:
    options = ExportOptions(format="mcap", **choice)
    with path.open("wb") as output:
        check(options).write(store, ExportSelection(store, find_row(store, session), options), output)
    return path


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_every_record_index_and_number_of_a_file_is_true(
    store: Store, session: int, tmp_path: Path, compression: str
) -> None:
    data = write(store, session, tmp_path / "dive.mcap", compression=compression).read_bytes()
    assert data.startswith(MAGIC)
    assert data.endswith(MAGIC)
    results = [*StreamReader(io.BytesIO(data), emit_chunks=True, validate_crcs=True).records]
    assert isinstance(results[0], records.Header)
    assert results[0].library == "mucat"
    assert isinstance(results[-1], records.Footer)
    assert results[-1].summary_crc != 0
    (end,) = (record for record in results if isinstance(record, records.DataEnd))
    assert end.data_section_crc != 0
    chunks = [record for record in results if isinstance(record, records.Chunk)]
    indexes = [record for record in results if isinstance(record, records.ChunkIndex)]
    assert len(chunks) == len(indexes) > 1
    counts: Counter[int] = Counter()
    for chunk, index in zip(chunks, indexes, strict=True):
        assert chunk.compression == ("" if compression == "none" else compression)
        assert chunk.uncompressed_crc != 0
        messages = [
            record
            for record in breakup_chunk(chunk, validate_crc=True)
            if isinstance(record, records.Message)
        ]
        counts.update(message.channel_id for message in messages)
        times = [message.log_time for message in messages]
        assert (index.message_start_time, index.message_end_time) == (min(times), max(times))
        at = index.chunk_start_offset
        again = next(
            iter(
                StreamReader(
                    io.BytesIO(data[at : at + index.chunk_length]), skip_magic=True, emit_chunks=True
                ).records
            )
        )
        assert isinstance(again, records.Chunk)
        assert again.data == chunk.data
        assert set(index.message_index_offsets) == {message.channel_id for message in messages}
    (statistics,) = (record for record in results if isinstance(record, records.Statistics))
    assert statistics.channel_message_counts == dict(counts)
    assert statistics.message_count == counts.total()
    assert statistics.chunk_count == len(chunks)
    kinds = Counter(type(record).__name__ for record in results)
    assert statistics.attachment_count == kinds["Attachment"] == kinds["AttachmentIndex"] == 2
    assert statistics.metadata_count == kinds["Metadata"] == kinds["MetadataIndex"] == 4
    groups = {record.group_opcode for record in results if isinstance(record, records.SummaryOffset)}
    assert len(groups) == kinds["SummaryOffset"] == 6


def test_messages_are_valid_by_their_schemas_and_both_ways_of_reading_agree(
    store: Store, session: int, tmp_path: Path
) -> None:
    path = write(store, session, tmp_path / "dive.mcap", compression="zstd")
    with path.open("rb") as file:
        sought = [*SeekingReader(file, validate_crcs=True).iter_messages()]
        file.seek(0)
        streamed = [*NonSeekingReader(file, validate_crcs=True).iter_messages()]
    assert [record[2] for record in sought] == [record[2] for record in streamed]
    validators: dict[str, Any] = {}
    for schema, _, message in sought:
        assert schema is not None
        if schema.name not in validators:
            validators[schema.name] = jsonschema_rs.validator_for(json.loads(schema.data))
        validators[schema.name].validate(json.loads(message.data))
    assert {"foxglove.CompressedImage", "foxglove.Log", "mucat.imu"} <= set(validators)


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_the_reader_of_foxglove_and_lichtblick_reads_all_of_it(
    store: Store, session: int, tmp_path: Path, compression: str
) -> None:
    path = write(store, session, tmp_path / "dive.mcap", compression=compression)
    done = subprocess.run(
        ["node", "mcap.mjs", str(path)], cwd=CLIENTS, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["whole"]
    assert answer["indexed"] == answer["streamed"]
    assert answer["indexed"]["/camera"] == 20
    assert sum(answer["indexed"].values()) == answer["statistics"]["messages"]
    assert set(answer["chunks"]) == {"" if compression == "none" else compression}
    # Each well-known schema is Foxglove's own.
    assert set(answer["schemas"]) == {
        "foxglove.CompressedImage",
        "foxglove.FrameTransform",
        "foxglove.Log",
        "foxglove.PoseInFrame",
    }
    assert all(answer["schemas"].values()), answer["schemas"]
    stored = find_row(store, session)
    assert answer["attachments"]["robot.toml"] == ["application/toml", stored.configuration]
    assert json.loads(answer["attachments"]["session.json"][1])["name"] == stored.name
    assert answer["metadata"]["session"]["identifier"] == stored.identifier


@pytest.mark.parametrize("topics", [["imu"], ["imu", "debug"], ["truth"], ["depth"]], ids=" and ".join)
def test_any_choice_of_topics_gives_a_file_with_the_pose_where_the_attitude_is_among_them(
    store: Store, session: int, tmp_path: Path, topics: list[str]
) -> None:
    path = write(store, session, tmp_path / "dive.mcap", topics=topics)
    with path.open("rb") as file:
        results = {channel.topic for _, channel, _ in SeekingReader(file).iter_messages()}
    assert {f"/{name}" for name in topics} <= results
    assert ("/pose" in results) is ("imu" in topics or "truth" in topics)


def test_the_seed_zero_is_a_seed(store: Store, session: int, tmp_path: Path) -> None:
    asyncio.run(store.write(lambda connection: connection.execute(update(SessionRow).values(seed=0))))
    with write(store, session, tmp_path / "dive.mcap").open("rb") as file:
        described = {entry.name: entry.metadata for entry in SeekingReader(file).iter_metadata()}
    assert described["session"]["seed"] == "0"


def test_compression_without_its_package_or_for_another_format_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(ExportRequestError, match="for mcap alone"):
        check(ExportOptions(format="csv", compression="zstd"))
    monkeypatch.setitem(sys.modules, "zstandard", None)
    with pytest.raises(ExportRequestError, match="pip install zstandard"):
        check(ExportOptions(format="mcap", compression="zstd"))
