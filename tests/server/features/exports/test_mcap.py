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
from server.features.sessions.session import find_row
from server.platform.models import SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
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
        Block.of(BY_NAME["thumbnail"], 1, place, row(100 + place / 10, bytes(100_000))) for place in range(20)
    ]
    return record(
        store,
        settings,
        [
            depth_block(0, 200),
            rows_block("imu", 0, *((100 + place / 100, imu(level)) for place in range(300))),
            rows_block("truth", 0, *((100 + place / 20, truth((1, 2, 3), level)) for place in range(60))),
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
    found = [*StreamReader(io.BytesIO(data), emit_chunks=True, validate_crcs=True).records]
    assert isinstance(found[0], records.Header)
    assert found[0].library == "mucat"
    assert isinstance(found[-1], records.Footer)
    assert found[-1].summary_crc != 0
    (end,) = (one for one in found if isinstance(one, records.DataEnd))
    assert end.data_section_crc != 0
    chunks = [one for one in found if isinstance(one, records.Chunk)]
    indexes = [one for one in found if isinstance(one, records.ChunkIndex)]
    assert len(chunks) == len(indexes) > 1
    counts: Counter[int] = Counter()
    for chunk, index in zip(chunks, indexes, strict=True):
        assert chunk.compression == ("" if compression == "none" else compression)
        assert chunk.uncompressed_crc != 0
        messages = [
            one for one in breakup_chunk(chunk, validate_crc=True) if isinstance(one, records.Message)
        ]
        counts.update(one.channel_id for one in messages)
        times = [one.log_time for one in messages]
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
        assert set(index.message_index_offsets) == {one.channel_id for one in messages}
    (statistics,) = (one for one in found if isinstance(one, records.Statistics))
    assert statistics.channel_message_counts == dict(counts)
    assert statistics.message_count == counts.total()
    assert statistics.chunk_count == len(chunks)
    kinds = Counter(type(one).__name__ for one in found)
    assert statistics.attachment_count == kinds["Attachment"] == kinds["AttachmentIndex"] == 2
    assert statistics.metadata_count == kinds["Metadata"] == kinds["MetadataIndex"] == 4
    groups = {one.group_opcode for one in found if isinstance(one, records.SummaryOffset)}
    assert len(groups) == kinds["SummaryOffset"] == 6


def test_messages_are_valid_by_their_schemas_and_both_ways_of_reading_agree(
    store: Store, session: int, tmp_path: Path
) -> None:
    path = write(store, session, tmp_path / "dive.mcap", compression="zstd")
    with path.open("rb") as file:
        sought = [*SeekingReader(file, validate_crcs=True).iter_messages()]
        file.seek(0)
        streamed = [*NonSeekingReader(file, validate_crcs=True).iter_messages()]
    assert [one[2] for one in sought] == [one[2] for one in streamed]
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
    found = json.loads(done.stdout)
    assert found["whole"]
    assert found["indexed"] == found["streamed"]
    assert found["indexed"]["/camera"] == 20
    assert sum(found["indexed"].values()) == found["statistics"]["messages"]
    assert set(found["chunks"]) == {"" if compression == "none" else compression}
    # Each well-known schema is Foxglove's own.
    assert set(found["schemas"]) == {
        "foxglove.CompressedImage",
        "foxglove.FrameTransform",
        "foxglove.Log",
        "foxglove.PoseInFrame",
    }
    assert all(found["schemas"].values()), found["schemas"]
    stored = find_row(store, session)
    assert found["attachments"]["robot.toml"] == ["application/toml", stored.configuration]
    assert json.loads(found["attachments"]["session.json"][1])["name"] == stored.name
    assert found["metadata"]["session"]["identifier"] == stored.identifier


@pytest.mark.parametrize("topics", [["imu"], ["imu", "debug"], ["truth"], ["depth"]], ids=" and ".join)
def test_any_choice_of_topics_gives_a_file_with_the_pose_where_the_attitude_is_among_them(
    store: Store, session: int, tmp_path: Path, topics: list[str]
) -> None:
    path = write(store, session, tmp_path / "dive.mcap", topics=topics)
    with path.open("rb") as file:
        found = {channel.topic for _, channel, _ in SeekingReader(file).iter_messages()}
    assert {f"/{name}" for name in topics} <= found
    assert ("/pose" in found) is ("imu" in topics or "truth" in topics)


def test_the_seed_zero_is_a_seed(store: Store, session: int, tmp_path: Path) -> None:
    asyncio.run(store.write(lambda connection: connection.execute(update(SessionRow).values(seed=0))))
    with write(store, session, tmp_path / "dive.mcap").open("rb") as file:
        described = {one.name: one.metadata for one in SeekingReader(file).iter_metadata()}
    assert described["session"]["seed"] == "0"


def test_compression_without_its_package_or_for_another_format_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(ExportRequestError, match="for mcap alone"):
        check(ExportOptions(format="csv", compression="zstd"))
    monkeypatch.setitem(sys.modules, "zstandard", None)
    with pytest.raises(ExportRequestError, match="pip install zstandard"):
        check(ExportOptions(format="mcap", compression="zstd"))
