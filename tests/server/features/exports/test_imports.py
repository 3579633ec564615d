"""Imports of valid and invalid archives."""

import asyncio
import io
import json
import math
import shutil
import zipfile
import zlib
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from sqlalchemy import Connection, insert, text, update
from sqlmodel import col, select

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.archive import CHECKSUMS, HEAD, SESSION
from robot_runtime.errors import RefusedError
from server.features.exports import imports
from server.features.exports.archive import write_archive
from server.features.exports.archive_models import GAPS_STORED, ArchivedGap
from server.features.exports.archive_reader import ArchiveError, examine, merge_gaps
from server.features.exports.imports import Imports
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.library.catalogue import Catalogue
from server.library.retention import RetentionWorker
from server.platform.disk_space import SPARE_BYTES, FileWriteError
from server.platform.models import BookmarkRow, Chunk, Gap, SessionRow, SessionTag
from server.platform.notices import Notices
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.sqlite import FULL
from server.platform.store import Reader, Store, StoreError
from server.recording.session import IMPORTING, REMOVING, UnknownSessionError, find_row
from tests.server.blocks import debug_block, depth_block, state_block
from tests.server.features.exports.recordings import record, record_batches
from tests.server.library.missions import mission_blocks
from tests.server.serving import serve
from tests.waiting import SECONDS

Members = dict[str, bytes]

BOTH_DATABASES = True


@pytest.fixture
def session(store: Store, settings: Settings) -> int:
    number = record(
        store,
        settings,
        [depth_block(0, 50), state_block(0)],
        [depth_block(60, 50), debug_block(0, "é"), *mission_blocks()],
    )

    def add(connection: Connection) -> None:
        marker = {"session_id": number, "time": 100.5, "text": "here", "made": 1e9}
        connection.execute(insert(BookmarkRow).values(marker))
        connection.execute(insert(SessionTag).values({"session_id": number, "tag": "pool"}))

    asyncio.run(store.write(add))
    return number


@pytest.fixture
def archive(store: Store, session: int, tmp_path: Path) -> Path:
    row = find_row(store, session)
    path = tmp_path / "dive.mucat.zip"
    with path.open("wb") as file:
        write_archive(store, ExportSelection(store, row, ExportOptions(format="archive")), file)
    return path


def contents(store: Reader, number: int) -> dict[str, Any]:
    """Return all that is stored of a session, but its number and origin."""
    with store.read() as database:
        row = database.get(SessionRow, number)
        assert row is not None
        report = row.model_dump(exclude={"id", "origin"})
        report["topics"], report["robot_state"] = json.loads(row.topics), json.loads(row.robot_state)
        for table in (Chunk, Gap, BookmarkRow, SessionTag):
            rows = database.exec(select(table).where(col(table.session_id) == number))
            values = [row.model_dump(exclude={"id", "session_id"}) for row in rows]
            report[table.__name__] = sorted(values, key=repr)
    return report


async def test_a_session_imported_elsewhere_is_unchanged(
    store: Store, settings: Settings, session: int, archive: Path, tmp_path: Path
) -> None:
    folder = DataFolder(tmp_path / "other")
    make_folders(folder)
    prepare(folder)
    with closing(Store(folder.database)) as elsewhere:
        await record_batches(elsewhere, settings, [depth_block(0, 1)])

    async with serve(replace(settings, data=folder)) as served:
        answer = await served.api.post("/imports", content=archive.read_bytes(), timeout=SECONDS)
        assert answer.status_code == 201, answer.text
        assert (answer.json()["id"], answer.json()["samples"]) == (2, 108)
        again = await served.api.post("/imports", content=archive.read_bytes(), timeout=SECONDS)
        assert again.status_code == 409
        assert "is here already, as number 2" in again.json()["detail"]
        bad = await served.api.post("/imports", content=archive.read_bytes()[:-100], timeout=SECONDS)
        assert (bad.status_code, "cut off" in bad.json()["detail"]) == (422, True)
        assert len((await served.api.get("/sessions")).json()) == 2
        assert list(folder.imports.iterdir()) == []
    with closing(Reader(folder.database)) as brought:
        assert contents(brought, 2) == contents(store, session)
        row = find_row(brought, 2)
    assert row.origin == "import"


def change(path: Path, edit: Callable[[Members], None], *, summed: bool = True) -> None:
    """Write the archive again with other members and matching checksums."""
    with zipfile.ZipFile(path) as zipped:
        members = {name: zipped.read(name) for name in zipped.namelist() if name != CHECKSUMS}
        sums = zipped.read(CHECKSUMS)
    edit(members)
    if summed:
        sums = json.dumps({name: sha256(data).hexdigest() for name, data in members.items()}).encode()
    with zipfile.ZipFile(path, "w") as zipped:
        for name, data in members.items():
            zipped.writestr(name, data)
        zipped.writestr(CHECKSUMS, sums)


def repack(path: Path, folder: str, *others: tuple[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> Path:
    """Return the archive in a folder, as macOS packs it again."""
    packed = path.with_name("packed.zip")
    added = [
        ("__MACOSX/dive/._session.json", b"\0\5"),
        (f"{folder}.DS_Store", b"\0"),
        (f"{folder}chunks/", b""),
    ]
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(packed, "w", method) as new:
        members = [(folder + name, old.read(name)) for name in old.namelist()]
        for name, data in [*members, *added, *others]:
            new.writestr(name, data)
    return packed


def tell(**changes: Any) -> Callable[[Members], None]:
    """Change entries of `session.json`, of the archive or of the session."""

    def edit(members: Members) -> None:
        message = json.loads(members[SESSION])
        for name, value in changes.items():
            (message if name in message else message["session"])[name] = value
        members[SESSION] = json.dumps(message).encode()

    return edit


def rename(old: str, new: str) -> Callable[[Members], None]:
    return lambda members: members.update({new: members.pop(old)})


def flip(members: Members) -> None:
    data = bytearray(members["chunks/depth"])
    data[HEAD.size + 30] ^= 0xFF
    members["chunks/depth"] = bytes(data)


def cut(members: Members) -> None:
    members["chunks/depth"] = members["chunks/depth"][:-7]


def count(members: Members) -> None:
    """A chunk whose count is one sample too high."""
    values = list(HEAD.unpack_from(members["chunks/depth"]))
    values[4] += 1
    members["chunks/depth"] = HEAD.pack(*values) + members["chunks/depth"][HEAD.size :]


def bomb(members: Members) -> None:
    data = zlib.compress(bytes(200_000_000), 9)
    members["chunks/debug"] = HEAD.pack(0, 1.0, 2.0, 0, 1, len(data), b"lines-zlib") + data


def row_bomb(members: Members) -> None:
    """A chunk of as many rows as it announces, 40 MB of them."""
    size = json.loads(members[SESSION])["session"]["topics"]["depth"]["row_bytes"]
    samples = 40_000_000 // size
    packer = zlib.compressobj(1)
    rows = bytes(size * 1000)
    data = b"".join([*(packer.compress(rows) for _ in range(samples // 1000)), packer.flush()])
    head = HEAD.pack(0, 1.0, 2.0, 0, samples // 1000 * 1000, len(data), b"shuffle-zlib")
    members["chunks/depth"] = head + data


def nonsense(members: Members) -> None:
    data = zlib.compress(b'{"time": 1}\n{"time": null}\n')
    members["chunks/debug"] = HEAD.pack(0, 1.0, 2.0, 0, 2, len(data), b"lines-zlib") + data


def endless(members: Members) -> None:
    data = members["chunks/debug"]
    values = list(HEAD.unpack_from(data))
    values[1] = math.inf
    members["chunks/debug"] = HEAD.pack(*values) + data[HEAD.size :]


BAD = {
    "a checksum that is another": (flip, False, "chunks/depth is damaged: its checksum"),
    "a chunk that does not unpack": (flip, True, "Chunk 0 of depth is damaged"),
    "a chunk that is cut": (cut, True, "chunks of depth are damaged: number 1 is cut off"),
    "too many samples": (count, True, "Chunk 0 of depth is damaged: it holds 50 samples instead of 51"),
    "a bomb": (bomb, True, "Chunk 0 of debug is damaged: it unpacks to more than 16000000 bytes"),
    "a bomb of rows": (row_bomb, True, "Chunk 0 of depth is damaged: it unpacks to more than 16000000 bytes"),
    "documents that are none": (nonsense, True, "Chunk 0 of debug is damaged: a document lacks level"),
    "a time that is none": (endless, True, "chunks of debug are damaged: number 0 has an invalid time"),
    "a newer format": (tell(version=2), True, "It has format 2; this version of µ-CAT reads format 1"),
    "another program's": (tell(format="x"), True, "is not that of an archive"),
    "no JSON": (lambda members: members.update({SESSION: b"{"}), True, "session.json is not JSON"),
    "no session": (lambda members: members.pop(SESSION), True, "no archive of a session"),
    "a path upwards": (rename("chunks/depth", "chunks/../../x"), True, "'chunks/../../x', which is no part"),
    "an absolute path": (rename("chunks/depth", "/etc/passwd"), True, "'/etc/passwd', which is no part"),
    "a topic that is not told": (rename("chunks/depth", "chunks/other"), True, "chunks of other, which"),
    "an identifier that is none": (tell(identifier="../x"), True, "session.identifier"),
    "a state that is none": (tell(state="recording"), True, "session.state"),
    "a start that is none": (tell(started="now"), True, "session.started"),
    "rows of another size": (
        tell(topics={"depth": {"meaning": "", "kind": "rows", "row_bytes": 9, "fields": []}}),
        True,
        "does not match its fields|which its session.json does not know",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_archive_is_refused_with_the_reason(archive: Path, name: str) -> None:
    edit, summed, message = BAD[name]
    change(archive, edit, summed=summed)
    with pytest.raises(ArchiveError, match=message):
        examine(archive, archive.with_suffix(".rows"))


def test_a_file_that_is_no_archive_is_refused(archive: Path, tmp_path: Path) -> None:
    whole = archive.read_bytes()
    for data in (b"", b"time,depth\n", whole[:1000], whole[:-1], whole[:200] + b"\0" * 50 + whole[250:]):
        other = tmp_path / "other"
        other.write_bytes(data)
        with pytest.raises(ArchiveError):
            examine(other, other.with_suffix(".rows"))
    examine(archive, archive.with_suffix(".rows"))


@pytest.mark.parametrize("folder", ["", "dive.mucat/", "dive/dive.mucat/", "dive.mucat\\"])
def test_an_archive_that_was_packed_again_is_imported(
    store: Store, settings: Settings, session: int, archive: Path, folder: str
) -> None:
    known = contents(store, session)
    packed = repack(archive, folder)
    asyncio.run(store.execute(update(SessionRow).values(identifier="f" * 32)))
    number = asyncio.run(Imports(settings.data, store).take(packed))
    assert contents(store, number) == known


def test_what_else_was_packed_is_named(archive: Path) -> None:
    packed = repack(archive, "dive/", ("dive/notes.docx", b"x"))
    with pytest.raises(
        ArchiveError, match=r"'notes\.docx', which is no part .* packed again\? Send the file as"
    ):
        examine(packed, packed.with_suffix(".rows"))
    packed = repack(archive, "", method=zipfile.ZIP_BZIP2)
    with pytest.raises(ArchiveError, match=r"compressed by another method\. .* packed again\?"):
        examine(packed, packed.with_suffix(".rows"))


def test_members_that_grow_much_are_not_unpacked(archive: Path) -> None:
    packed = repack(archive, "", ("chunks/bomb", bytes(10_000_000)))
    assert packed.stat().st_size < 100_000
    with pytest.raises(ArchiveError, match="larger than the file"):
        examine(packed, packed.with_suffix(".rows"))


def test_what_is_no_zip_file_is_refused_before_a_process_is_started(
    store: Store, settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(imports, "ExportProcess")
    short = tmp_path / "short.zip"
    short.write_bytes(b"abc")
    with pytest.raises(ArchiveError, match="It is no zip file, or it is cut off"):
        asyncio.run(Imports(settings.data, store).take(short))


def test_a_session_that_records_is_not_archived(store: Store, session: int) -> None:
    row = find_row(store, session)
    row.state = "recording"
    with pytest.raises(ExportRequestError, match="Stop the recording"):
        write_archive(store, ExportSelection(store, row, ExportOptions(format="archive")), io.BytesIO())


async def test_a_failed_import_leaves_nothing_and_is_never_visible(
    store: Store, settings: Settings, session: int, archive: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    change(archive, tell(identifier="f" * 32))
    seen: list[int] = []

    imports = Imports(settings.data, store)
    real = store.execute

    async def failing(change: Any, rows: Any = None) -> int:
        count = await real(change, rows)
        seen.extend(session.id for session in Catalogue(store).page().sessions)
        if change.table.name == "chunk":
            raise StoreError("the disk is full")
        return count

    monkeypatch.setattr(store, "execute", failing)
    with pytest.raises(StoreError):
        await imports.take(archive)
    assert set(seen) == {session}
    with store.read() as database:
        states = database.exec(select(SessionRow.state).order_by(col(SessionRow.id))).all()
    assert states == ["complete", REMOVING]


async def test_an_import_whose_failure_could_not_be_stored_does_not_block_the_next(
    store: Store, settings: Settings, session: int, archive: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    change(archive, tell(identifier="f" * 32))

    async def fail(*_: object, **__: object) -> int:
        raise StoreError(FULL)

    imports = Imports(settings.data, store)
    with monkeypatch.context() as full:
        full.setattr(imports, "_fill_chunks", fail)
        drop, marked = imports._drop_unfinished, 0

        async def drop_first() -> None:
            nonlocal marked
            marked += 1
            if marked > 1:
                raise StoreError(FULL)
            await drop()

        full.setattr(imports, "_drop_unfinished", drop_first)
        with pytest.raises(StoreError):
            await imports.take(archive)
    with pytest.raises(RefusedError, match="is being removed"):
        await imports.take(archive)
    await RetentionWorker(store, settings, Notices(clock := SimulatedClock(), print), clock).apply(1e9)
    assert await imports.take(archive) > session


def test_an_archive_larger_than_the_free_space_is_refused_before_reading(
    store: Store, settings: Settings, session: int, archive: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    change(archive, tell(identifier="f" * 32))
    size = archive.stat().st_size
    disk = SimpleNamespace(free=size + SPARE_BYTES - 1)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: disk)
    imports = Imports(settings.data, store)
    with pytest.raises(FileWriteError, match="Free some space"):
        asyncio.run(imports.take(archive))
    assert [session.id for session in Catalogue(store).page().sessions] == [session]
    disk.free += 1
    asyncio.run(imports.take(archive))
    assert len(Catalogue(store).page().sessions) == 2


def test_a_half_imported_session_of_a_killed_server_is_removed(
    store: Store, settings: Settings, session: int
) -> None:
    half = text(f"UPDATE session SET state = '{IMPORTING}'")
    asyncio.run(store.write(lambda connection: connection.execute(half)))
    with pytest.raises(UnknownSessionError):
        find_row(store, session)
    settings.data.imports.mkdir()
    (settings.data.imports / "x.part").write_bytes(b"half")
    asyncio.run(Imports(settings.data, store).recover())
    assert list(settings.data.imports.iterdir()) == []
    with store.read() as database:
        assert database.exec(select(SessionRow.state)).all() == [REMOVING]


def test_gaps_beyond_what_can_be_shown_are_merged_and_nothing_of_them_is_lost() -> None:
    gaps = [
        ArchivedGap(topic=topic, kind="missed", time=100.0 + position, missed=2)
        for position in range(15_000)
        for topic in ("depth", "imu")
    ]
    merged = merge_gaps(gaps)
    assert len(merged) <= GAPS_STORED
    for topic in ("depth", "imu"):
        own = [gap for gap in merged if gap.topic == topic]
        assert sum(gap.missed for gap in own) == 30_000
        assert own[0].time == 100.0
    few = gaps[:GAPS_STORED]
    assert merge_gaps(few) == few
    strange = [ArchivedGap(topic=f"t{n}", kind="missed", time=1.0, missed=1) for n in range(2000)]
    with pytest.raises(ValueError, match="more than 200 topics"):
        merge_gaps(strange)
