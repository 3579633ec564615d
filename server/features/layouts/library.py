"""Saved layouts in the database. All methods raise StoreError."""

import json
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from pydantic import Field
from sqlalchemy import Connection, delete, func, update
from sqlalchemy.orm import defer
from sqlmodel import col, select

from robot_runtime.errors import RefusedError
from server.features.layouts.document import LayoutDocument
from server.platform.edited_meanwhile import ChangedMeanwhileError
from server.platform.errors import NotFoundError
from server.platform.models import LayoutRow
from server.platform.schema_base import Schema
from server.platform.store import Store, insert_row

LAYOUTS_MOST = 200


class UnknownLayoutError(NotFoundError):
    """There is no such layout"""


class SavedLayout(Schema):
    """A layout by its name."""

    id: int
    name: str
    saved: datetime
    author: str = Field(description="the person who saved it; empty where it is not known")
    version: int = Field(description="counts its changes from 1")


class LayoutDetails(SavedLayout):
    """A saved layout with its document, which may be of another version of the program."""

    document: dict[str, Any]


class Layouts:
    """The layouts of a database."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def list(self) -> Sequence[SavedLayout]:
        """Return all layouts, by name."""
        whole = select(LayoutRow).options(defer(LayoutRow.document))  # type: ignore[arg-type]
        with self._store.read() as database:
            return [_show(row) for row in database.exec(whole.order_by(func.lower(LayoutRow.name)))]

    def get(self, layout: int) -> LayoutDetails:
        """Return the layout of this number. Raise UnknownLayoutError."""
        with self._store.read() as database:
            row = database.get(LayoutRow, layout)
            if row is None:
                raise UnknownLayoutError(f"There is no layout {layout}. Somebody may have deleted it.")
            return LayoutDetails(**_show(row).model_dump(), document=json.loads(row.document))

    async def save(
        self, name: str, document: LayoutDocument, author: str = "", base: int | None = None
    ) -> SavedLayout:
        """Save a layout, replacing one of the same name.

        `base` is the version that it replaces, 0 for a new layout; None replaces any. Raise RefusedError if
        there are too many, ChangedMeanwhileError.
        """
        text, now = document.model_dump_json(exclude_none=True), time.time()
        columns = (col(LayoutRow.id), col(LayoutRow.version), col(LayoutRow.author))

        def write(connection: Connection) -> SavedLayout:
            existing = connection.execute(select(*columns).where(LayoutRow.name == name)).first()
            there, version, last = existing or (None, 0, "")
            if base is not None and base != version:
                raise ChangedMeanwhileError(f"The layout “{name}”", last, gone=existing is None)
            row = LayoutRow(id=there, name=name, document=text, saved=now, author=author, version=version + 1)
            values = row.model_dump(exclude={"id"})
            if there is not None:
                connection.execute(update(LayoutRow).where(col(LayoutRow.id) == there).values(values))
                return _show(row)
            count = connection.execute(select(func.count()).select_from(LayoutRow)).scalar_one()
            if count >= LAYOUTS_MOST:
                raise RefusedError(f"There are {LAYOUTS_MOST} layouts already. Delete one that nobody needs.")
            row.id = insert_row(connection, LayoutRow, values)
            return _show(row)

        return await self._store.write(write)

    async def delete(self, layout: int) -> None:
        """Delete a layout for good. Raise UnknownLayoutError."""

        def write(connection: Connection) -> None:
            if connection.execute(delete(LayoutRow).where(col(LayoutRow.id) == layout)).rowcount == 0:
                raise UnknownLayoutError(f"There is no layout {layout}. Somebody may have deleted it.")

        await self._store.write(write, frees=True)


def _show(row: LayoutRow) -> SavedLayout:
    saved = datetime.fromtimestamp(row.saved, UTC)
    return SavedLayout(id=row.id or 0, name=row.name, saved=saved, author=row.author, version=row.version)
