"""Saved layouts in the database. All methods raise StoreError."""

import json
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from pydantic import BaseModel
from sqlalchemy import Connection, delete, func, update
from sqlmodel import col, select

from robot_runtime.errors import RefusedError
from server.features.layouts.document import LayoutDocument
from server.platform.errors import NotFoundError
from server.platform.models import LayoutRow
from server.platform.store import Store, insert_row

LAYOUTS_MOST = 200


class UnknownLayoutError(NotFoundError):
    """There is no such layout"""


class SavedLayout(BaseModel):
    """A layout by its name."""

    id: int
    name: str
    saved: datetime


class LayoutDetails(SavedLayout):
    """A saved layout with its document, which may be of another version of the program."""

    document: dict[str, Any]


class Layouts:
    """The layouts of a database."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def list(self) -> Sequence[SavedLayout]:
        """All of them, by name."""
        columns = (col(LayoutRow.id), col(LayoutRow.name), col(LayoutRow.saved))
        with self._store.read() as database:
            found = database.exec(select(*columns).order_by(func.lower(LayoutRow.name))).all()
        return [SavedLayout(id=key or 0, name=name, saved=_utc(saved)) for key, name, saved in found]

    def get(self, layout: int) -> LayoutDetails:
        """The layout of this number. Raises UnknownLayoutError."""
        with self._store.read() as database:
            row = database.get(LayoutRow, layout)
            if row is None:
                raise UnknownLayoutError(f"There is no layout {layout}. Somebody may have deleted it.")
            return LayoutDetails(
                id=layout, name=row.name, saved=_utc(row.saved), document=json.loads(row.document)
            )

    async def save(self, name: str, document: LayoutDocument) -> SavedLayout:
        """Save a layout, replacing one of the same name. Raises RefusedError if there are too many."""
        text, now = document.model_dump_json(exclude_none=True), time.time()

        def write(connection: Connection) -> int:
            found = connection.execute(select(LayoutRow.id).where(LayoutRow.name == name)).scalar()
            if found is not None:
                change = update(LayoutRow).where(col(LayoutRow.id) == found)
                connection.execute(change.values(document=text, saved=now))
                return int(found)
            count = connection.execute(select(func.count()).select_from(LayoutRow)).scalar_one()
            if count >= LAYOUTS_MOST:
                raise RefusedError(f"There are {LAYOUTS_MOST} layouts already. Delete one that nobody needs.")
            return insert_row(connection, LayoutRow, {"name": name, "document": text, "saved": now})

        return SavedLayout(id=await self._store.write(write), name=name, saved=_utc(now))

    async def delete(self, layout: int) -> None:
        """Delete a layout for good. Raises UnknownLayoutError."""

        def write(connection: Connection) -> None:
            if connection.execute(delete(LayoutRow).where(col(LayoutRow.id) == layout)).rowcount == 0:
                raise UnknownLayoutError(f"There is no layout {layout}. Somebody may have deleted it.")

        await self._store.write(write)


def _utc(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, UTC)
