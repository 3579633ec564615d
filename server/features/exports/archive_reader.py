"""Reads and checks archives, which may be damaged, foreign, cut off or malicious.

The check covers the names of the members, their size when unpacked, the checksums, and the decoding of every
chunk to the samples that its head announces.
"""

import hashlib
import json
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from typing import IO, Annotated, Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from robot_runtime.contract.topics import TIME
from server.features.exports.archive import CHECKSUMS, CHUNKS, FORMAT, HEAD, SESSION, VERSION
from server.features.sessions.chunks import (
    CHUNK_BYTES_MAX,
    DOCUMENTS_ENCODING,
    PICTURES_ENCODING,
    ROWS_ENCODING,
    decode_pictures,
    unpack,
)
from server.platform.errors import InvalidError

SESSION_BYTES_MAX = 32_000_000
STEP_BYTES = 1 << 20
MEMBER = re.compile(r"session\.json|checksums\.json|chunks/[a-z][a-z0-9_]{0,49}")
CODES = "bBhHiIqQfd?"
ENCODINGS = {"rows": ROWS_ENCODING, "documents": DOCUMENTS_ENCODING, "picture": PICTURES_ENCODING}

Text = Annotated[str, Field(max_length=1_000_000)]
Words = Annotated[str, Field(max_length=10_000)]
Time = Annotated[float, Field(ge=-1e15, le=1e15, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, lt=1 << 62)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,49}$")]


class ArchiveError(InvalidError):
    """The file is no archive that can be imported"""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)


class TopicField(_Strict):
    """A field of a topic, as `chunks.describe_topics` writes it; of documents only the name."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,99}$")]
    code: Annotated[str, Field(min_length=1, max_length=1)] | None = None
    count: Annotated[int, Field(ge=1, le=1000)] = 1
    scale: float = 1
    unit: Annotated[str, Field(max_length=50)] = ""
    meaning: Words = ""


class ArchivedTopic(_Strict):
    """A topic, as `chunks.describe_topics` writes it."""

    meaning: Words
    kind: Literal["rows", "documents", "picture"]
    row_bytes: int = 0
    fields: Annotated[list[TopicField], Field(max_length=1000)]

    @model_validator(mode="after")
    def _agrees(self) -> "ArchivedTopic":
        if self.kind == "rows":
            if any(field.code is None or field.code not in CODES for field in self.fields):
                raise ValueError("its fields have unknown types")
            codes = "<" + "".join(f"{field.count}{field.code}" for field in self.fields)
            if self.row_bytes != TIME.size + struct.calcsize(codes):
                raise ValueError("the length of its rows does not match its fields")
        return self


class ArchivedSession(_Strict):
    """The session's columns (see `SessionRow`)."""

    identifier: Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
    name: Annotated[str, Field(min_length=1, max_length=1000)]
    note: Words
    state: Literal["complete", "interrupted"]
    robot: Words
    version: Words
    definitions: Words
    started: Annotated[float, Field(ge=0, le=253e9)]
    started_steady: Time
    ended: Annotated[float, Field(ge=0, le=253e9)] | None
    duration: Annotated[float, Field(ge=0, le=1e12)]
    configuration: Text
    robot_state: dict[str, Any] | None
    topics: dict[Name, ArchivedTopic]
    boot: Words = ""
    scenario: Text = ""
    scenario_name: Words = ""
    seed: Annotated[int, Field(ge=-(1 << 62), lt=1 << 62)] | None = None
    firmware: Words = ""
    software: Words = ""


class ArchivedBookmark(_Strict):
    """The columns of a bookmark (see `BookmarkRow`)."""

    time: Time
    text: Words
    made: Time


class ArchivedGap(_Strict):
    """The columns of a gap (see `Gap`)."""

    topic: Words
    kind: Words
    time: Time
    missed: Count


class ArchivedDocument(_Strict):
    """The content of `session.json`."""

    session: ArchivedSession
    tags: Annotated[list[Annotated[str, Field(min_length=1, max_length=1000)]], Field(max_length=10_000)]
    markers: Annotated[list[ArchivedBookmark], Field(max_length=100_000)]
    gaps: Annotated[list[ArchivedGap], Field(max_length=1_000_000)]


class ArchivedChunk(NamedTuple):
    """The columns of a chunk (see `Chunk`)."""

    topic: str
    number: int
    first_time: float
    last_time: float
    first: int
    samples: int
    encoding: str
    data: bytes


class Archive:
    """An open archive with valid names of members and a valid `session.json`."""

    def __init__(self, zipped: zipfile.ZipFile, size: int) -> None:
        self._zipped = zipped
        self._names = self._check_members(size)
        self._sums = self._read_json(CHECKSUMS)
        if not isinstance(self._sums, dict):
            raise ArchiveError(f"{CHECKSUMS} is not an object.")
        self.content, self.described_topics = self._session()
        """The content of `session.json`, and its descriptions of topics word for word."""
        self.topics = [name.removeprefix(CHUNKS) for name in self._names if name.startswith(CHUNKS)]
        strange = [name for name in self.topics if name not in self.content.session.topics]
        if strange:
            raise ArchiveError(f"It holds chunks of {', '.join(strange)}, which its {SESSION} does not know.")

    def chunks(self, topic: str) -> Iterator[ArchivedChunk]:
        """The chunks of a topic with plausible heads; their data is not checked."""
        number = -1
        with self._zipped.open(CHUNKS + topic) as file:
            while head := file.read(HEAD.size):
                if len(head) < HEAD.size:
                    raise ArchiveError(f"The chunks of {topic} are cut off after number {number}.")
                chunk_number, first_time, last_time, first, count, size, encoding = HEAD.unpack(head)
                if size > CHUNK_BYTES_MAX or count == 0:
                    raise ArchiveError(f"A chunk of {topic} announces {count} samples in {size} bytes.")
                if chunk_number <= number:
                    raise ArchiveError(f"Chunk {chunk_number} of {topic} comes after number {number}.")
                if not (isfinite(first_time) and isfinite(last_time)) or first < 0:
                    raise ArchiveError(f"Chunk {chunk_number} of {topic} has an invalid time or number.")
                number = chunk_number
                data = file.read(size)
                if len(data) < size:
                    raise ArchiveError(f"Chunk {number} of {topic} is cut off.")
                name = encoding.rstrip(b"\0").decode("ascii", "replace")
                yield ArchivedChunk(topic, number, first_time, last_time, first, count, name, data)

    def verify(self, report: Callable[[float], None]) -> None:
        """Check the checksums, and every chunk's samples. Raises ArchiveError."""
        total = sum(info.file_size for info in self._zipped.infolist())
        done = 0
        for name in self._names:
            checksum = hashlib.sha256()
            with self._zipped.open(name) as file:
                while piece := file.read(STEP_BYTES):
                    checksum.update(piece)
                    done += len(piece)
                    report(0.5 * done / total)
            if self._sums.get(name) != checksum.hexdigest():
                raise ArchiveError(f"{name} is damaged: its checksum is not the one in {CHECKSUMS}.")
        for place, topic in enumerate(self.topics):
            for chunk in self.chunks(topic):
                self._decode(chunk)
            report(0.5 + 0.5 * (place + 1) / len(self.topics))

    def _check_members(self, size: int) -> list[str]:
        infos = self._zipped.infolist()
        names = [info.filename for info in infos]
        strange = [name for name in names if not MEMBER.fullmatch(name)]
        if strange:
            raise ArchiveError(f"It holds {strange[0][:100]!r}, which is no part of an archive.")
        if len(set(names)) < len(names):
            raise ArchiveError("It holds two members of the same name.")
        if SESSION not in names or CHECKSUMS not in names:
            raise ArchiveError(f"It holds no {SESSION} or no {CHECKSUMS}, so it is no archive of a session.")
        if any(info.compress_type != zipfile.ZIP_STORED or info.flag_bits & 1 for info in infos):
            raise ArchiveError("Its members are compressed or encrypted; an archive stores them unchanged.")
        if sum(info.file_size for info in infos) > size:
            raise ArchiveError("Its members are larger than the file.")
        return [name for name in names if name != CHECKSUMS]

    def _read_json(self, name: str) -> Any:
        with self._zipped.open(name) as file:
            text = file.read(SESSION_BYTES_MAX + 1)
        if len(text) > SESSION_BYTES_MAX:
            raise ArchiveError(f"{name} is longer than {SESSION_BYTES_MAX} bytes.")
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as problem:
            raise ArchiveError(f"{name} is not JSON: {problem}") from problem

    def _session(self) -> tuple[ArchivedDocument, dict[str, Any]]:
        document = self._read_json(SESSION)
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
            return ArchivedDocument.model_validate(document), document["session"]["topics"]
        except ValidationError as problem:
            first = problem.errors()[0]
            where = ".".join(str(place) for place in first["loc"])
            raise ArchiveError(f"Its {SESSION} is not valid: {where}: {first['msg']}") from problem

    def _decode(self, chunk: ArchivedChunk) -> None:
        topic = self.content.session.topics[chunk.topic]
        where = f"Chunk {chunk.number} of {chunk.topic}"
        expected = ENCODINGS[topic.kind]
        if chunk.encoding != expected:
            raise ArchiveError(f"{where} is encoded as {chunk.encoding!r}, which this version cannot read.")
        if topic.kind == "picture":
            _check_pictures(chunk, where)
            return
        announced = CHUNK_BYTES_MAX if topic.kind == "documents" else chunk.samples * topic.row_bytes
        limit = min(CHUNK_BYTES_MAX, announced)
        try:
            data = unpack(chunk.data, limit)
        except (ValueError, zlib.error) as problem:
            raise ArchiveError(f"{where} is damaged: {problem}.") from problem
        if topic.kind == "rows":
            if len(data) != announced:
                raise ArchiveError(f"{where} has {len(data)} bytes, which are not {chunk.samples} samples.")
            return
        try:
            documents = [json.loads(line) for line in data.splitlines()]
            times = [float(document["time"]) for document in documents]
        except (ValueError, TypeError, KeyError, RecursionError) as problem:
            raise ArchiveError(f"{where} does not hold documents with a time: {problem}") from problem
        if len(times) != chunk.samples or not all(map(isfinite, times)):
            raise ArchiveError(f"{where} does not hold {chunk.samples} documents with a time.")


def examine(path: Path, report: Callable[[float], None] = lambda _: None) -> None:
    """Check a whole archive. Raises ArchiveError."""
    with open_archive(path) as archive:
        archive.verify(report)


@contextmanager
def open_archive(path: Path) -> Iterator[Archive]:
    """Open an archive for reading. Raises ArchiveError, also for errors while it is read."""
    try:
        file: IO[bytes]
        with path.open("rb") as file, zipfile.ZipFile(file) as zipped:
            yield Archive(zipped, path.stat().st_size)
    except zipfile.BadZipFile as problem:
        raise ArchiveError(
            f"It is no zip file, cut off or damaged ({problem}). Copy it again, and compare its checksum."
        ) from problem
    except (NotImplementedError, EOFError, OSError, UnicodeError) as problem:
        raise ArchiveError(f"It cannot be read: {problem}") from problem


def _check_pictures(chunk: ArchivedChunk, where: str) -> None:
    try:
        times = [time for time, _ in decode_pictures(chunk.data)]
    except ValueError as problem:
        raise ArchiveError(f"{where} is damaged: {problem}") from problem
    if len(times) != chunk.samples or not all(map(isfinite, times)):
        raise ArchiveError(f"{where} does not hold {chunk.samples} pictures with a time.")
