"""Annotation, deletion and restoration of the stored sessions."""

from collections.abc import Mapping, Sequence
from time import time
from typing import Any

from sqlalchemy import Connection, delete, insert, update
from sqlmodel import col, select

from server.library.listing import Listing
from server.platform.edited_meanwhile import ChangedMeanwhileError
from server.platform.models import SessionRow, SessionTag
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.schemas import Session
from server.recording.session import EDITED, HIDDEN, REMOVING, SessionStateError, require

TEXTS = {"name": "The name, now “{}”,", "note": "The note of “{}”", "tags": "A tag of “{}”"}
"""The texts of a session in words, with its name."""


class Catalogue(Listing):
    """Write access to the sessions; `recorder` is informed of changes to the recording one."""

    def __init__(self, store: Store, recorder: Recorder | None = None) -> None:
        super().__init__(store)
        self._store = store
        self._recorder = recorder

    async def change(
        self,
        session: int,
        *,
        name: str | None = None,
        note: str | None = None,
        tags: Sequence[str] | None = None,
        kept: bool | None = None,
        base: Mapping[str, Any] | None = None,
    ) -> Session:
        """Change name, note, tags or protection of a session; None leaves a field unchanged.

        `base` has the texts that the editing began from. Raise ChangedMeanwhileError.
        """
        changes = {"name": name, "note": note, "kept": kept}
        values = {field: value for field, value in changes.items() if value is not None}

        def write(connection: Connection) -> None:
            require(connection, session)
            new_texts = {"name": name, "note": note, "tags": None if tags is None else sorted(set(tags))}
            _check_base(connection, session, new_texts, base)
            connection.execute(
                update(SessionRow).where(col(SessionRow.id) == session).values({**values, **EDITED})
            )
            if tags is not None:
                connection.execute(delete(SessionTag).where(col(SessionTag.session_id) == session))
                rows = [{"session_id": session, "tag": tag} for tag in dict.fromkeys(tags)]
                if rows:
                    connection.execute(insert(SessionTag), rows)

        await self._store.write(write)
        return self.notify(session)

    async def delete(self, session: int) -> Session:
        """Move a session to the bin. Raise SessionStateError for one that records."""

        def write(connection: Connection) -> None:
            if require(connection, session) == "recording":
                raise SessionStateError("This session is recording. Stop it first, then delete it.")
            unset = col(SessionRow.deleted).is_(None)
            query = update(SessionRow).where(col(SessionRow.id) == session, unset)
            connection.execute(query.values(deleted=time()))

        await self._store.write(write, frees=True)
        return self.find(session)

    async def restore(self, session: int) -> Session:
        """Take a session out of the bin."""
        there = col(SessionRow.id) == session, col(SessionRow.state).not_in(HIDDEN)
        await self._store.execute(update(SessionRow).where(*there).values(deleted=None))
        return self.find(session)

    async def purge(self, session: int) -> None:
        """Mark a session of the bin for removal; it disappears at once.

        Raise SessionStateError outside the bin.
        """

        def write(connection: Connection) -> None:
            require(connection, session)
            query = select(SessionRow.deleted).where(SessionRow.id == session)
            if connection.execute(query).scalar() is None:
                raise SessionStateError("This session is not in the bin. Delete it first.")
            connection.execute(update(SessionRow).where(col(SessionRow.id) == session).values(state=REMOVING))

        await self._store.write(write, frees=True)

    async def note_archived(self, identifiers: Sequence[str]) -> None:
        """Note that a lab has these sessions; those that are not here are passed over."""
        those = col(SessionRow.identifier).in_(identifiers), col(SessionRow.archived).is_(None)
        await self._store.execute(update(SessionRow).where(*those).values(archived=time()))

    def notify(self, session: int) -> Session:
        """Report a session's new state to the pages, if it is being recorded."""
        row = self.find(session)
        if self._recorder is not None:
            self._recorder.amend(row)
        return row


def _check_base(
    connection: Connection, session: int, new_texts: Mapping[str, Any], base: Mapping[str, Any] | None
) -> None:
    """Refuse to replace a text that is neither that of `base` nor the new one.

    Raise ChangedMeanwhileError.
    """
    if base is None:
        return
    texts = connection.execute(select(SessionRow.name, SessionRow.note).where(col(SessionRow.id) == session))
    values = texts.mappings().one()
    tags = connection.execute(select(SessionTag.tag).where(col(SessionTag.session_id) == session)).scalars()
    present = {**values, "tags": sorted(tags)}
    for text, new in new_texts.items():
        began = base[text]
        if (
            new is not None
            and began is not None
            and present[text] not in (new, sorted(began) if text == "tags" else began)
        ):
            raise ChangedMeanwhileError(TEXTS[text].format(values["name"]), "")
