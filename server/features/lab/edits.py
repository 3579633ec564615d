"""Edits on a robot after its session was pulled: they follow into the archive, and replace none of the lab's.

Name, note, tags and bookmarks are compared with what came from the robot last. One that is still so here gets
the robot's; one that was changed here stays. The dates are always the robot's.
"""

import json
from collections.abc import Mapping
from time import time
from typing import Any

from sqlalchemy import Connection, delete, insert, update
from sqlmodel import col, select

from server.features.lab.robot_client import RobotsTexts
from server.library.schemas import SessionEdits
from server.platform.models import BookmarkRow, PulledSessionRow, SessionRow, SessionTag

TEXTS = ("name", "note", "tags", "bookmarks")
UNKNOWN = -1
"""The number of edits of a session whose texts have not come from the robot itself."""


def note_pulled(connection: Connection, session: SessionEdits, robot: str) -> None:
    """Note that a session was pulled from this robot just now."""
    number = connection.execute(
        select(SessionRow.id).where(SessionRow.identifier == session.identifier)
    ).scalar_one()
    _note(connection, session, robot, session.edits, json.dumps(_read(connection, number)))


def note_here(connection: Connection, session: SessionEdits, robot: str) -> None:
    """Note that a session is here which the pull has not noted: nobody knows what of it was changed here."""
    _note(connection, session, robot, UNKNOWN, "{}")


def _note(connection: Connection, session: SessionEdits, robot: str, edits: int, texts: str) -> None:
    values = {
        "identifier": session.identifier,
        "robot": robot,
        "pulled": time(),
        "edits": edits,
        "texts": texts,
    }
    connection.execute(insert(PulledSessionRow).values(values))


def follow(connection: Connection, session: SessionEdits, theirs: RobotsTexts) -> None:
    """Take over what was changed on the robot, but not where the lab has changed it, too."""
    here = col(SessionRow.identifier) == session.identifier
    row = connection.execute(select(SessionRow.id, SessionRow.started_steady).where(here)).one_or_none()
    if row is None:
        return
    number, start = row
    pulled = col(PulledSessionRow.identifier) == session.identifier
    last = json.loads(connection.execute(select(PulledSessionRow.texts).where(pulled)).scalar_one())
    ours = _read(connection, number)
    new: Mapping[str, Any] = {
        "name": theirs.name,
        "note": theirs.note,
        "tags": sorted(theirs.tags),
        "bookmarks": [[start + mark.time, mark.text, mark.made.timestamp()] for mark in theirs.marks],
    }
    followed = {text: new[text] for text in TEXTS if ours[text] in (last.get(text), new[text])}
    dates = {"started": theirs.started.timestamp(), "ended": theirs.ended.timestamp()}
    _write(connection, number, followed, dates)
    values = {"edits": session.edits, "texts": json.dumps({**last, **followed})}
    connection.execute(update(PulledSessionRow).where(pulled).values(values))


def _read(connection: Connection, session: int) -> dict[str, Any]:
    columns = select(SessionRow.name, SessionRow.note).where(col(SessionRow.id) == session)
    name, note = connection.execute(columns).one()
    tags = connection.execute(select(SessionTag.tag).where(col(SessionTag.session_id) == session)).scalars()
    mark = BookmarkRow
    bookmarks = select(mark.time, mark.text, mark.made).where(col(mark.session_id) == session)
    rows = connection.execute(bookmarks.order_by(col(mark.time), col(mark.id)))
    return {"name": name, "note": note, "tags": sorted(tags), "bookmarks": [list(row) for row in rows]}


def _write(
    connection: Connection, session: int, texts: Mapping[str, Any], dates: Mapping[str, float]
) -> None:
    values = {text: texts[text] for text in ("name", "note") if text in texts}
    connection.execute(update(SessionRow).where(col(SessionRow.id) == session).values({**values, **dates}))
    if "tags" in texts:
        connection.execute(delete(SessionTag).where(col(SessionTag.session_id) == session))
        for tag in texts["tags"]:
            connection.execute(insert(SessionTag).values(session_id=session, tag=tag))
    if "bookmarks" in texts:
        connection.execute(delete(BookmarkRow).where(col(BookmarkRow.session_id) == session))
        for moment, text, made in texts["bookmarks"]:
            mark = {"session_id": session, "time": moment, "text": text, "made": made}
            connection.execute(insert(BookmarkRow).values(mark))
