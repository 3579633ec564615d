"""Writes the archive of a session: `robot_runtime.contract.archive` has its format."""

import json
from typing import Any, BinaryIO

from sqlmodel import SQLModel, col, select

from robot_runtime.contract.archive import (
    CHUNKS,
    FORMAT,
    SESSION,
    VERSION,
    pack_chunk,
)
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.features.exports.summed_members import SummedMembers
from server.platform.models import BookmarkRow, Gap, SessionTag
from server.platform.store import Reader


def write_archive(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """Write the archive of a whole session. Raise ExportRequestError while it records, StoreError."""
    if source.row.state == "recording":
        raise ExportRequestError(
            "The session is still being recorded. Stop the recording, then make the archive."
        )
    members = SummedMembers(output)
    with members.member(SESSION) as write:
        write(json.dumps(_describe(store, source), indent=1, ensure_ascii=False).encode())
    for name in source.names:
        with members.member(CHUNKS + name) as write:
            for chunk in source.chunks(name):
                write(pack_chunk(chunk))
    members.close()


def _describe(store: Reader, source: ExportSelection) -> dict[str, Any]:
    row = source.row
    session = row.model_dump(exclude={"id", "deleted", "kept", "archived", "edits"})
    session |= {"robot_state": json.loads(row.robot_state), "topics": json.loads(row.topics)}
    with store.read() as database:

        def rows(table: type[SQLModel], order: str) -> list[dict[str, Any]]:
            query = select(table).where(getattr(table, "session_id") == row.id)  # noqa: B009
            rows = database.exec(query.order_by(col(getattr(table, order))))
            return [row.model_dump(exclude={"id", "session_id"}) for row in rows]

        parts = {
            "tags": [row["tag"] for row in rows(SessionTag, "tag")],
            "markers": rows(BookmarkRow, "time"),
            "gaps": rows(Gap, "id"),
        }
    return {"format": FORMAT, "version": VERSION, "session": session, **parts}
