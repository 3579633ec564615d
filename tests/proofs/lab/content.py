"""Sessions as they are stored on a robot and in a lab's archive, and a robot's control ticks."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from itertools import pairwise
from pathlib import Path

from sqlalchemy import create_engine, pool
from sqlmodel import Session, col, select

from robot_runtime.contract.chunks import (
    DOCUMENTS_ENCODING,
    ROWS_ENCODING,
    decode_documents,
    decode_pictures,
    decode_rows,
)
from robot_runtime.contract.topics import BY_NAME
from server.platform.models import Chunk, SessionRow
from tests.proofs.kills import row_times

TICK = 0.1
"""s between two control ticks."""


@dataclass(frozen=True, slots=True)
class MissedTicks:
    """The control ticks that were left out in a time, and the longest pause between two (s)."""

    count: int
    longest: float


def read_content(database: Path | str) -> dict[str, str]:
    """Return the SHA-256 of each ended session's samples, by the session's identifier.

    It does not depend on how the samples are packed into chunks.
    """
    with _open(database) as session:
        ended = select(SessionRow.id, SessionRow.identifier).where(
            col(SessionRow.state) == "complete", col(SessionRow.deleted).is_(None)
        )
        return {identifier: _sum(session, number) for number, identifier in session.exec(ended)}


def read_identifiers(database: Path | str) -> list[str]:
    """Return the identifiers of all sessions that are ended, also of those in the bin."""
    with _open(database) as session:
        return list(
            session.exec(select(SessionRow.identifier).where(col(SessionRow.state) == "complete")).all()
        )


def read_ticks(database: Path) -> list[float]:
    """Return the times of all recorded control ticks (s, steady clock), in order."""
    with _open(database) as session:
        data = session.exec(select(Chunk.data).where(col(Chunk.topic) == "control"))
        return sorted(time for chunk in data for time in row_times("control", chunk))


def count_missed(ticks: Sequence[float], began: float, ended: float) -> MissedTicks:
    """Return the ticks that were left out between two times (s, steady clock)."""
    pauses = [after - before for before, after in pairwise(ticks) if before >= began and after <= ended]
    # One that is late is followed by one that is early.
    missed = sum(round(pause / TICK) - 1 for pause in pauses)
    return MissedTicks(max(missed, 0), max(pauses, default=0.0))


def _open(database: Path | str) -> Session:
    url = f"sqlite:///{database}" if isinstance(database, Path) else database
    return Session(create_engine(url, poolclass=pool.NullPool))


def _sum(session: Session, number: int | None) -> str:
    chunks = select(Chunk.topic, Chunk.encoding, Chunk.data).where(col(Chunk.session_id) == number)
    topic_before, whole = "", sha256()
    for topic, encoding, data in session.exec(chunks.order_by(col(Chunk.topic), col(Chunk.number))):
        if topic != topic_before:
            whole.update(f"\n{topic}\n".encode())
            topic_before = topic
        for piece in _decode(topic, encoding, data):
            whole.update(piece)
    return whole.hexdigest()


def _decode(topic: str, encoding: str, data: bytes) -> Iterable[bytes]:
    if encoding == ROWS_ENCODING:
        return (decode_rows(data, BY_NAME[topic].row_bytes),)
    if encoding == DOCUMENTS_ENCODING:
        return (json.dumps(document, sort_keys=True).encode() for document in decode_documents(data))
    return (part for time, picture in decode_pictures(data) for part in (repr(time).encode(), picture))
