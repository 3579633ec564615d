"""Reads and checks archives, which may be damaged, foreign, cut off or malicious.

The check covers the names of the members, their size when unpacked, the checksums, and the decoding of every
chunk to the samples that its head announces. An archive that was unpacked and packed again, as Safari and the
Finder do, has its members compressed in a folder, and others beside them; it is read as well.
"""

import hashlib
import json
import re
import zipfile
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from math import ceil
from pathlib import Path
from typing import IO, Any, TypeVar, get_args

from pydantic import ValidationError

from robot_runtime.contract.archive import (
    CHECKSUMS,
    CHUNKS,
    FORMAT,
    SESSION,
    VERSION,
    read_chunks,
)
from robot_runtime.contract.chunks import StoredChunk
from robot_runtime.contract.topics import STATE
from robot_runtime.zip_members import find_members
from server.features.exports.archive_models import (
    COLUMNS_MAX,
    GAPS_STORED,
    MISSED_MAX,
    TOPICS_MAX,
    ArchivedDocument,
    ArchivedGap,
)
from server.features.exports.archive_samples import SPAN_MAX, check_chunk, check_document
from server.platform.errors import InvalidError
from server.platform.limits import NOTES_MAX
from server.recording.schemas import GapKind

SESSION_BYTES_MAX = 32_000_000
DESCRIPTION_BYTES_MAX = 1_000_000
ROWS_AT_ONCE = 1_000
"""Rows in one line, each of at most 20 kB, and in one transaction."""
STEP_BYTES = 1 << 20
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
GROWTH_MAX = 4
"""Most bytes of chunks for each byte of the file: they are compressed, so packing them again gains little."""
AS_DOWNLOADED = "Was it unpacked and packed again? Send the file as it was downloaded."
MEMBER = re.compile(r"session\.json|checksums\.json|chunks/[a-z][a-z0-9_]{0,49}")


class ArchiveError(InvalidError):
    """The file is no archive that can be imported"""


class ArchiveChunks:
    """The chunks in an archive with valid names of members; `session.json` is not read."""

    def __init__(self, zipped: zipfile.ZipFile, size: int) -> None:
        self._zipped = zipped
        self._members = self._check_members(size)
        self.topics = [name.removeprefix(CHUNKS) for name in self._members if name.startswith(CHUNKS)]

    def chunks(self, topic: str) -> Iterator[StoredChunk]:
        """Yield the chunks of a topic with plausible heads; their data is not checked."""
        with self._zipped.open(self._members[CHUNKS + topic]) as file:
            try:
                yield from read_chunks(file)
            except ValueError as problem:
                raise ArchiveError(f"Its chunks of {topic} are damaged: {problem}.") from problem

    def _check_members(self, size: int) -> dict[str, zipfile.ZipInfo]:
        try:
            members = find_members(self._zipped, SESSION)
        except ValueError as problem:
            raise ArchiveError("It holds two members of the same name.") from problem
        strange = [name for name in members if not MEMBER.fullmatch(name)]
        if strange:
            raise ArchiveError(
                f"It holds {strange[0][:100]!r}, which is no part of an archive. {AS_DOWNLOADED}"
            )
        if SESSION not in members or CHECKSUMS not in members:
            raise ArchiveError(f"It holds no {SESSION} or no {CHECKSUMS}, so it is no archive of a session.")
        if any(info.compress_type not in METHODS or info.flag_bits & 1 for info in members.values()):
            raise ArchiveError(f"Its members are encrypted, or compressed by another method. {AS_DOWNLOADED}")
        chunks = sum(info.file_size for name, info in members.items() if name.startswith(CHUNKS))
        if chunks > GROWTH_MAX * size:
            raise ArchiveError("Its members are larger than the file.")
        return members


class Archive(ArchiveChunks):
    """An open archive with valid names of members and a valid `session.json`.

    Reading a large `session.json` takes seconds and much memory: not for the server's process.
    """

    def __init__(self, zipped: zipfile.ZipFile, size: int) -> None:
        super().__init__(zipped, size)
        self._sums = self._parse(CHECKSUMS, self._read(CHECKSUMS))
        if not isinstance(self._sums, dict):
            raise ArchiveError(f"{CHECKSUMS} is not an object.")
        self.described_session = self._read(SESSION)
        self.content, self.described_topics = self._session()
        """The content of `session.json`, and its descriptions of topics word for word."""
        strange = [name for name in self.topics if name not in self.content.session.topics]
        if strange:
            raise ArchiveError(f"It holds chunks of {', '.join(strange)}, which its {SESSION} does not know.")

    def verify(self, report: Callable[[float], None]) -> None:
        """Check the checksums, and every chunk's samples. Raise ArchiveError."""
        total = sum(info.file_size for info in self._members.values())
        done = 0
        for name in (name for name in self._members if name != CHECKSUMS):
            checksum = hashlib.sha256()
            with self._zipped.open(self._members[name]) as file:
                while piece := file.read(STEP_BYTES):
                    checksum.update(piece)
                    done += len(piece)
                    report(0.5 * done / total)
            if self._sums.get(name) != checksum.hexdigest():
                raise ArchiveError(f"{name} is damaged: its checksum is not the one in {CHECKSUMS}.")
        session = self.content.session
        for index, topic in enumerate(self.topics):
            for chunk in self.chunks(topic):
                try:
                    check_chunk(chunk, topic, session.topics[topic], session.started_steady)
                except ValueError as problem:
                    raise ArchiveError(f"Chunk {chunk.number} of {topic} is damaged: {problem}.") from problem
            report(0.5 + 0.5 * (index + 1) / len(self.topics))

    def _read(self, name: str) -> bytes:
        with self._zipped.open(self._members[name]) as file:
            text = file.read(SESSION_BYTES_MAX + 1)
        if len(text) > SESSION_BYTES_MAX:
            raise ArchiveError(f"{name} is longer than {SESSION_BYTES_MAX} bytes.")
        return text

    def _parse(self, name: str, text: bytes) -> Any:
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as problem:
            raise ArchiveError(f"{name} is not JSON: {problem}") from problem

    def _session(self) -> tuple[ArchivedDocument, dict[str, Any]]:
        document = self._parse(SESSION, self.described_session)
        if not isinstance(document, dict) or document.get("format") != FORMAT:
            raise ArchiveError(
                f"Its {SESSION} is not that of an archive; export the session in the format archive."
            )
        version = document.get("version")
        if version != VERSION:
            raise ArchiveError(
                f"It has format {version!r}; this version of µ-CAT reads format {VERSION}. "
                "Install the version of µ-CAT that wrote it, or a newer one."
            )
        try:
            content = ArchivedDocument.model_validate(document)
        except ValidationError as problem:
            first = problem.errors()[0]
            where = ".".join(str(part) for part in first["loc"])
            raise ArchiveError(f"Its {SESSION} is not valid: {where}: {first['msg']}") from problem
        described: dict[str, Any] = document["session"]["topics"]
        try:
            _check_session(content, described)
        except ValueError as problem:
            raise ArchiveError(f"Its {SESSION} is not valid: {problem}.") from problem
        return content, described


Reading = TypeVar("Reading", bound=ArchiveChunks)


def examine(path: Path, rows: Path, report: Callable[[float], None] = lambda _: None) -> None:
    """Check a whole archive, and write the rows of its session to the file `rows`. Raise ArchiveError.

    Lines of JSON: first the columns of the session, then of some bookmarks, gaps or tags each.
    """
    with open_archive(path, Archive) as archive:
        archive.verify(report)
        with rows.open("w", encoding="utf-8") as file:
            for line in _describe_rows(archive):
                file.write(json.dumps(line, ensure_ascii=False) + "\n")


@contextmanager
def open_archive(path: Path, reader: type[Reading]) -> Iterator[Reading]:
    """Open an archive for reading. Raise ArchiveError, also for errors while it is read."""
    try:
        file: IO[bytes]
        with path.open("rb") as file, zipfile.ZipFile(file) as zipped:
            yield reader(zipped, path.stat().st_size)
    except zipfile.BadZipFile as problem:
        raise ArchiveError(
            f"It is no zip file, cut off or damaged ({problem}). Copy it again, and compare its checksum."
        ) from problem
    except (NotImplementedError, EOFError, OSError, UnicodeError) as problem:
        raise ArchiveError(f"It cannot be read: {problem}") from problem


def _describe_rows(archive: Archive) -> Iterator[dict[str, Any]]:
    content = archive.content
    session = content.session.model_dump(exclude={"topics", "robot_state"})
    session["topics"] = json.dumps(archive.described_topics, ensure_ascii=False)
    session["robot_state"] = json.dumps(content.session.robot_state, ensure_ascii=False)
    yield {"session": session}
    small: dict[str, list[dict[str, Any]]] = {
        "tags": [{"tag": tag} for tag in dict.fromkeys(content.tags)],
        "markers": [marker.model_dump() for marker in content.markers],
        "gaps": [gap.model_dump() for gap in content.gaps],
    }
    for table, rows in small.items():
        for at in range(0, len(rows), ROWS_AT_ONCE):
            yield {table: rows[at : at + ROWS_AT_ONCE]}


def merge_gaps(gaps: Sequence[ArchivedGap]) -> list[ArchivedGap]:
    """Return at most `GAPS_STORED` gaps: beyond that, neighbours of one topic and kind are merged.

    A merged gap has the first one's time, and misses the samples of all. Raise ValueError for more
    topics than a session may have.
    """
    groups: defaultdict[tuple[str, str], list[ArchivedGap]] = defaultdict(list)
    for gap in gaps:
        groups[gap.topic, gap.kind].append(gap)
    if len(groups) > len(get_args(GapKind)) * TOPICS_MAX:
        raise ValueError(f"its gaps are of more than {TOPICS_MAX} topics")
    if len(gaps) <= GAPS_STORED:
        return [*gaps]
    together = ceil(len(gaps) / (GAPS_STORED - len(groups)))
    merged: list[ArchivedGap] = []
    for alike in groups.values():
        alike.sort(key=lambda gap: gap.time)
        for at in range(0, len(alike), together):
            some = alike[at : at + together]
            missed = min(sum(gap.missed for gap in some), MISSED_MAX)
            merged.append(some[0].model_copy(update={"missed": missed}))
    return sorted(merged, key=lambda gap: gap.time)


def _check_session(content: ArchivedDocument, described: dict[str, Any]) -> None:
    """Merge its gaps. Raise ValueError where this version cannot read or show the session."""
    session = content.session
    for name, value in {"topics": described, "robot_state": session.robot_state}.items():
        if len(json.dumps(value)) > DESCRIPTION_BYTES_MAX:
            raise ValueError(f"{name} is longer than {DESCRIPTION_BYTES_MAX} bytes")
    if session.robot_state is not None:
        check_document(session.robot_state, STATE.name)
    columns = sum(topic.columns for topic in session.topics.values())
    if columns > COLUMNS_MAX:
        raise ValueError(f"its topics have {columns} columns; at most {COLUMNS_MAX} can be shown")
    content.gaps = merge_gaps(content.gaps)
    times = [marker.time for marker in content.markers] + [gap.time for gap in content.gaps]
    if any(abs(time - session.started_steady) > SPAN_MAX for time in times):
        raise ValueError("a bookmark or a gap is far from the session")
    if sum(len(marker.text) for marker in content.markers) > NOTES_MAX:
        raise ValueError(f"the notes at its bookmarks have more than {NOTES_MAX} characters")
