"""Who changed which parameters, and the way back, one change after the other.

The runtime says with its answer to a command what the command changed. That is stored; what was changed
before the runtime's last start cannot be undone, for a start brings the defaults back.
"""

import asyncio
import json
import logging
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from time import time
from typing import Any

from sqlalchemy import Connection, delete, insert, update
from sqlmodel import col, desc, select

from robot_runtime.errors import RefusedError
from server.features.parameters.schemas import Change, ChangedValue, LeftOut, Restored
from server.platform.models import ParameterChangeRow
from server.platform.store import Store, StoreError
from server.stream.bridge import Bridge

log = logging.getLogger(__name__)

SHOWN = 100
KEPT = 1000


class Changes:
    """Every command that may change parameters passes here.

    Every method raises RefusedError, RuntimeSilentError, or StoreError where the history cannot be read.
    """

    def __init__(self, store: Store, bridge: Bridge) -> None:
        self._store = store
        self._bridge = bridge
        self._undoing = asyncio.Lock()

    async def command(self, who: str, name: str, payload: Mapping[str, Any], why: str = "") -> Restored:
        """Have the runtime do it, and note what that changed; answers what was changed and what was not."""
        answer = await self._bridge.tune(name, payload)
        changed = [
            ChangedValue(name=one, before=before, after=after)
            for one, (before, after) in answer.get("changed", {}).items()
        ]
        left_out = [LeftOut(name=one, why=reason) for one, reason in answer.get("left_out", {}).items()]
        if changed:
            await self._note(who, why, changed)
        return Restored(changed=changed, left_out=left_out)

    def newest(self) -> list[Change]:
        """The newest first. Blocks."""
        query = select(ParameterChangeRow).order_by(desc(col(ParameterChangeRow.id))).limit(SHOWN)
        with self._store.read() as database:
            rows = database.exec(query).all()
            newest = _newest(rows, self._bridge.run)
            return [_show(row, newest is not None and row.id == newest.id) for row in rows]

    async def undo(self, who: str, change: int) -> Restored:
        """Set back what this change changed, which must be the newest that is not undone."""
        async with self._undoing:
            row = await asyncio.to_thread(self._find_newest)
            if row is None:
                raise RefusedError("Nothing is left to be undone since the robot's runtime has started.")
            if row.id != change:
                raise RefusedError("Somebody has changed something since. Look at the list, and try again.")
            values = _values(row)
            payload = {
                "values": {one.name: one.before for one in values},
                "expected": {one.name: one.after for one in values},
            }
            await self._bridge.tune("parameters", payload)
            await self._store.write(
                lambda connection: connection.execute(
                    update(ParameterChangeRow).where(col(ParameterChangeRow.id) == change).values(undone=who)
                )
            )
        undone = [ChangedValue(name=one.name, before=one.after, after=one.before) for one in values]
        return Restored(changed=undone, left_out=[])

    async def _note(self, who: str, why: str, changed: list[ChangedValue]) -> None:
        row = ParameterChangeRow(
            time=time(),
            run=self._bridge.run,
            who=who,
            why=why,
            changed=json.dumps([one.model_dump() for one in changed]),
        )
        try:
            await self._store.write(lambda connection: _insert(connection, row))
        except StoreError as problem:
            # It is in force; a history with a hole is better than an answer that denies it.
            log.warning("a change of parameters cannot be stored: %s", problem)

    def _find_newest(self) -> ParameterChangeRow | None:
        mine = col(ParameterChangeRow.run) == self._bridge.run
        query = select(ParameterChangeRow).where(mine, col(ParameterChangeRow.undone) == "")
        with self._store.read() as database:
            return database.exec(query.order_by(desc(col(ParameterChangeRow.id))).limit(1)).first()


def _newest(rows: Sequence[ParameterChangeRow], run: str) -> ParameterChangeRow | None:
    return next((row for row in rows if row.run == run and not row.undone), None)


def _insert(connection: Connection, row: ParameterChangeRow) -> None:
    key = connection.execute(
        insert(ParameterChangeRow).values(row.model_dump(exclude={"id"}))
    ).inserted_primary_key
    assert key is not None
    connection.execute(delete(ParameterChangeRow).where(col(ParameterChangeRow.id) <= int(key[0]) - KEPT))


def _values(row: ParameterChangeRow) -> list[ChangedValue]:
    return [ChangedValue.model_validate(one) for one in json.loads(row.changed)]


def _show(row: ParameterChangeRow, undoable: bool) -> Change:
    return Change(
        id=row.id or 0,
        time=datetime.fromtimestamp(row.time, UTC),
        who=row.who,
        why=row.why,
        values=_values(row),
        undone=row.undone,
        undoable=undoable,
    )
