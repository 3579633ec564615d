"""Merges the chunks of an archive to about one a minute: fewer rows, and half the bytes."""

import zlib
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from robot_runtime.contract.archive import CHUNKS, SESSION, pack_chunk
from robot_runtime.contract.chunks import LEVEL, StoredChunk, join_shuffled, unpack, unpack_rows
from server.features.exports.archive_models import ArchivedTopic
from server.features.exports.archive_reader import Archive, ArchiveError, open_archive
from server.features.exports.summed_members import SummedMembers

SECONDS = 60.0
BYTES_MAX = 4_000_000
"""Of one merged chunk, unpacked."""


def write_merged(path: Path, merged: Path) -> None:
    """Write a checked archive again, with its chunks merged. Raise ArchiveError, OSError."""
    with open_archive(path, Archive) as archive, merged.open("wb") as file:
        members = SummedMembers(file)
        with members.member(SESSION) as write:
            write(archive.described_session)
        for name in archive.topics:
            with members.member(CHUNKS + name) as write:
                try:
                    for chunk in merge(archive.chunks(name), archive.content.session.topics[name]):
                        write(pack_chunk(chunk))
                except ValueError as problem:
                    raise ArchiveError(f"Its chunks of {name} are damaged: {problem}.") from problem
        members.close()


def merge(chunks: Iterable[StoredChunk], topic: ArchivedTopic) -> Iterator[StoredChunk]:
    """Yield chunks that follow each other as one; their numbers count from 0. Raise ValueError.

    Pictures and films stay as they are: what is shown of them is read by the chunk.
    """
    number = size = 0
    group = list[StoredChunk]()
    unpacked = list[bytes]()
    for chunk in chunks:
        payload = b"" if topic.kind in ("picture", "film") else _unpack(chunk, topic)
        if group and (not payload or not _follows(group, chunk) or size + len(payload) > BYTES_MAX):
            yield _join(group, unpacked, topic, number)
            number, group, unpacked, size = number + 1, [], [], 0
        group.append(chunk)
        unpacked.append(payload)
        size += len(payload)
    if group:
        yield _join(group, unpacked, topic, number)


def _follows(group: list[StoredChunk], chunk: StoredChunk) -> bool:
    before = group[-1]
    return chunk.first == before.first + before.count and (
        group[0].first_time <= before.last_time <= chunk.last_time <= group[0].first_time + SECONDS
    )


def _unpack(chunk: StoredChunk, topic: ArchivedTopic) -> bytes:
    return unpack_rows(chunk.data, topic.row_bytes) if topic.kind == "rows" else unpack(chunk.data)


def _join(group: list[StoredChunk], unpacked: list[bytes], topic: ArchivedTopic, number: int) -> StoredChunk:
    first, last = group[0], group[-1]
    if len(group) == 1:
        return replace(first, number=number)
    whole = join_shuffled(unpacked, topic.row_bytes) if topic.kind == "rows" else b"".join(unpacked)
    data = zlib.compress(whole, LEVEL)
    count = sum(chunk.count for chunk in group)
    return replace(first, number=number, last_time=last.last_time, count=count, data=data)
