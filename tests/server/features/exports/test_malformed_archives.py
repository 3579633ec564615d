"""Archives with unexpected content are refused; what is stored in spite of it is reported in words."""

import asyncio
import json
import random
import shutil
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.contract.archive import CHUNKS, HEAD, SESSION
from server.analysis.comparer import Comparer
from server.analysis.schemas import ComparisonQuery
from server.features.exports import archive_reader, imports
from server.features.exports.archive_reader import ROWS_AT_ONCE, ArchiveError, examine
from server.features.exports.export_process import ExportProcessError
from server.features.exports.imports import Imports
from server.library.catalogue import Catalogue
from server.library.content import Recording, RecordingError, reading_content
from server.library.replay import RANGE_MAX, read_blocks_between
from server.library.timeline import read_timeline
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.released import ARCHIVE, RELEASED, SIGNALS
from tests.server.features.exports.test_imports import Members, change, tell

Edit = Callable[[Members], None]
Document = dict[str, Any]


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    """The session of 0.2.0, which has every topic."""
    return Path(shutil.copy(RELEASED / "0.2.0" / ARCHIVE, tmp_path))


def restate(topic: str, edit: Callable[[Document], object]) -> Edit:
    """Change the first document of a topic."""

    def restated(members: Members) -> None:
        data = members[CHUNKS + topic]
        head = list(HEAD.unpack_from(data))
        packed, rest = data[HEAD.size : HEAD.size + head[5]], data[HEAD.size + head[5] :]
        first, *lines = zlib.decompress(packed).splitlines()
        document = json.loads(first)
        edit(document)
        changed = zlib.compress(b"\n".join([json.dumps(document).encode(), *lines]))
        head[5] = len(changed)
        members[CHUNKS + topic] = HEAD.pack(*head) + changed + rest

    return restated


def announce(position: int, value: Any) -> Edit:
    """Change an entry of the head of the first chunk of depth."""

    def announced(members: Members) -> None:
        head = list(HEAD.unpack_from(members[CHUNKS + "depth"]))
        head[position] = value
        members[CHUNKS + "depth"] = HEAD.pack(*head) + members[CHUNKS + "depth"][HEAD.size :]

    return announced


def mark(**changes: Any) -> Edit:
    return tell(markers=[{"time": 1.5, "text": "here", "made": 1e9} | changes])


def gap(**changes: Any) -> Edit:
    return tell(gaps=[{"topic": "depth", "kind": "missed", "time": 1.5, "missed": 1} | changes])


MALFORMED = {
    "a gap of a kind that there is not": (gap(kind="strange"), "gaps.0.kind"),
    "a gap of another century": (gap(time=1e15), "far from the session"),
    "a bookmark made in another age": (mark(made=1e15), "markers.0.made"),
    "a bookmark of another century": (mark(time=1e14), "far from the session"),
    "an event without a kind": (
        restate("event", lambda document: document.pop("kind")),
        "a document lacks kind",
    ),
    "an odd severity": (restate("event", lambda item: item.update(severity="odd")), "'odd' is no"),
    "a time in words": (restate("state", lambda entry: entry.update(time="5")), "'5' is no"),
    "a time that is true": (restate("debug", lambda element: element.update(time=True)), "True is no"),
    "a time that is no number": (
        restate("debug", lambda member: member.update(time=float("nan"))),
        "holds NaN",
    ),
    "other times than announced": (announce(1, -1.0), "other times than it announces"),
    "odd controllers": (restate("state", lambda fields: fields["loops"][0].update(controllers=5)), "5 is no"),
    "odd parameters": (restate("parameters", lambda fields: fields.update(parameters="odd")), "'odd' is no"),
    "an odd state at the start": (tell(robot_state={"time": "x"}), "'x' is no"),
    "a long state at the start": (tell(robot_state={"x": "y" * 1_100_000}), "robot_state is longer than"),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_a_malformed_archive_is_refused_with_the_reason(archive: Path, name: str) -> None:
    edit, text = MALFORMED[name]
    examine(archive, archive.with_suffix(".rows"))
    change(archive, edit)
    with pytest.raises(ArchiveError, match=text):
        examine(archive, archive.with_suffix(".rows"))


def read_all(store: Store, number: int) -> Iterator[Callable[[], object]]:
    """Yield the readings of a session that pages ask for."""
    row = find_row(store, number)
    recording = Recording(store, row)
    start = row.started_steady

    def read(work: Callable[[], object]) -> object:
        with reading_content(row):
            return work()

    yield lambda: Catalogue(store).page().sessions
    yield lambda: Catalogue(store).detail(number)
    yield lambda: read(lambda: read_timeline(recording))
    yield lambda: read(lambda: read_blocks_between(recording, start, start + RANGE_MAX, 10.0))
    query = ComparisonQuery(sessions=[number], signals=SIGNALS, points=20)
    yield lambda: Comparer(store).compare(query).model_dump_json()


class InProcess:
    """Examines in this process, which is quicker than in one of its own."""

    def __init__(self, arguments: Sequence[str], _progress: object) -> None:
        _, path, rows = arguments
        self._paths = Path(path), Path(rows)

    async def run(self) -> None:
        try:
            examine(*self._paths)
        except ArchiveError as problem:
            raise ExportProcessError(problem.detail) from problem


STRANGE: list[Any] = [
    None,
    True,
    -1,
    0,
    1e300,
    -1e300,
    float("nan"),
    "",
    "5",
    "x" * 50,
    [],
    {},
    [[]],
    {"time": 1},
    "\0",
]


def mutate(value: Any, chance: random.Random) -> Any:
    """Replace something within a JSON value."""
    if isinstance(value, dict) and value and chance.random() < 0.95:
        name = chance.choice(list(value))
        if chance.random() < 0.1:
            return {key: content for key, content in value.items() if key != name}
        return value | {name: mutate(value[name], chance)}
    if isinstance(value, list) and value and chance.random() < 0.95:
        position = chance.randrange(len(value))
        return [*value[:position], mutate(value[position], chance), *value[position + 1 :]]
    return chance.choice(STRANGE)


def mutate_somewhere(chance: random.Random) -> Edit:
    def edit(members: Members) -> None:
        topic = chance.choice(["state", "event", "parameters", "vision", "detection", "debug"])
        kind = chance.randrange(4)
        if kind == 0:
            members[SESSION] = json.dumps(mutate(json.loads(members[SESSION]), chance)).encode()
        elif kind == 1:
            name = chance.choice([name for name in members if name.startswith(CHUNKS)])
            data = bytearray(members[name])
            data[chance.randrange(HEAD.size)] = chance.randrange(256)
            members[name] = bytes(data)
        else:

            def replace(document: Document) -> None:
                changed = mutate(document, chance)
                document.clear()
                document.update(changed if isinstance(changed, dict) else {"odd": changed})

            restate(topic, replace)(members)

    return edit


@pytest.mark.parametrize("seed", range(25))
def test_a_mutated_archive_is_refused_or_readable(
    settings: Settings, store: Store, archive: Path, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(imports, "ExportProcess", InProcess)
    change(archive, mutate_somewhere(random.Random(seed)))
    try:
        number = asyncio.run(Imports(settings.data, store).take(archive))
    except ArchiveError:
        return
    for read in read_all(store, number):
        try:
            read()
        except RecordingError as problem:
            assert "Other sessions are not affected." in problem.detail  # noqa: PT017


STORED = {
    "an event without a kind": ("event", lambda fields: fields.pop("kind")),
    "odd controllers": ("state", lambda fields: fields["loops"][0].update(controllers=5)),
    "odd parameters": ("parameters", lambda fields: fields.update(parameters=[5])),
}
"""Content that earlier versions let in."""


@pytest.mark.parametrize("name", STORED)
def test_stored_content_that_is_not_expected_is_reported(
    settings: Settings, store: Store, archive: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(imports, "ExportProcess", InProcess)
    monkeypatch.setattr(archive_reader.Archive, "verify", lambda *_: None)
    topic, edit = STORED[name]
    change(archive, restate(topic, edit))
    number = asyncio.run(Imports(settings.data, store).take(archive))
    problems: list[str] = []
    for read in read_all(store, number):
        try:
            read()
        except RecordingError as problem:
            problems.append(problem.detail)
    assert problems != []
    assert all("its content is not as expected" in problem for problem in problems)


def test_a_server_reads_no_session_of_an_archive_in_its_own_process(
    settings: Settings, store: Store, archive: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    item = {"topic": "depth", "kind": "missed", "time": 1.5, "missed": 1}
    count = 2 * ROWS_AT_ONCE + 1
    change(archive, tell(gaps=[item] * count))
    monkeypatch.setattr(archive_reader, "Archive", None)
    stored: list[int] = []
    execute = store.execute

    async def measure(statement: Any, rows: Any = None) -> int:
        if rows is not None:
            stored.append(len(rows))
        return await execute(statement, rows)

    monkeypatch.setattr(store, "execute", measure)
    number = asyncio.run(Imports(settings.data, store).take(archive))
    assert Catalogue(store).detail(number).gap_count == count
    assert max(stored) <= ROWS_AT_ONCE
