"""History of parameter changes, with undo one change at a time.

The runtime's answer to a command lists the parameters that the command changed. They are stored. Changes from
before the runtime's last start cannot be undone: a start restores the defaults.
"""

import asyncio
import json
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from time import time
from typing import Any

from sqlalchemy import Connection, delete, update
from sqlmodel import col, desc, select

from robot_runtime.contract.commands import ParametersCommand, RobotCommand
from robot_runtime.errors import RefusedError
from server.driving.schemas import Change, ChangedValue, LeftOut, Restored
from server.platform.models import ParameterChangeRow
from server.platform.store import Store, StoreError, insert_row
from server.stream.bridge import BUSY, TURN_SECONDS, Bridge, RuntimeSilentError

log = logging.getLogger(__name__)

SHOWN = 100
CHANGES_MOST = 1000

COMMAND_ERRORS = (RuntimeSilentError, {409: "The runtime refuses"})
"""Errors of an operation that sends a command to the robot."""

Send = Callable[[RobotCommand], Awaitable[None]]


@dataclass(slots=True)
class _Group:
    """Changes that are stored as one: each parameter's first and last value."""

    who: str
    why: str
    changed: dict[str, tuple[Any, Any]] = field(default_factory=dict)


class Changes:
    """The commands to the runtime, with the history of their changes of parameters.

    All commands except STOP pass through it. Every method raises RefusedError, RuntimeSilentError, or
    StoreError if the history cannot be read. A change that cannot be stored is only in the server's log.
    """

    def __init__(self, store: Store, bridge: Bridge) -> None:
        self._store = store
        self._bridge = bridge
        self._order = asyncio.Lock()
        """Held from a command's sending until its changes are stored, which keeps the robot's order."""
        self.listeners: list[Callable[[Mapping[str, Any]], None]] = []
        """Called with the new values of changed parameters, which the runtime's next document says, too."""
        self._groups: list[_Group] = []
        self._undone: dict[int, str] = {}
        """Names of those who have undone a change, by its number, where that could not be stored."""

    async def command(
        self,
        who: str,
        command: RobotCommand,
        why: str = "",
        check: Callable[[], Awaitable[None]] | None = None,
    ) -> Restored:
        """Send a command; return the changed and the omitted parameters.

        `check` may refuse it within its turn, so that no other command comes between.
        """
        async with self._turn():
            if check is not None:
                await check()
            answer = await self._send(command)
            changed = answer.get("changed", {})
            if changed:
                await self._note_groups()
                await self._note(who, why, changed)
        left_out = [LeftOut(name=name, why=reason) for name, reason in answer.get("left_out", {}).items()]
        return Restored(changed=_changed_values(changed), left_out=left_out)

    @asynccontextmanager
    async def together(self, who: str, why: str) -> AsyncIterator[Send]:
        """Send several commands, whose changes the history stores as one at the end."""
        group = _Group(who, why)

        async def send(command: RobotCommand) -> None:
            async with self._turn():
                answer = await self._send(command)
                for name, (before, after) in answer.get("changed", {}).items():
                    first = group.changed[name][0] if name in group.changed else before
                    group.changed[name] = (first, after)

        self._groups.append(group)
        try:
            yield send
        finally:
            async with self._order:
                self._groups.remove(group)
                await self._note_group(group)

    async def put_back(self, command: RobotCommand) -> None:
        """Send a command that restores values of the history; its changes are not stored."""
        async with self._turn():
            await self._send(command)

    def newest(self) -> list[Change]:
        """Return the newest changes, newest first. Blocks."""
        query = select(ParameterChangeRow).order_by(desc(col(ParameterChangeRow.id))).limit(SHOWN)
        with self._store.read() as database:
            rows = database.exec(query).all()
            open_ = (row.id for row in rows if row.run == self._bridge.run and not self._undone_by(row))
            newest = next(open_, None)
            return [_show(row, self._undone_by(row), row.id == newest) for row in rows]

    async def undo(self, who: str, change: int) -> Restored:
        """Undo a change, which must be the newest that is not undone."""
        async with self._turn():
            await self._note_groups()
            row = await asyncio.to_thread(self._find_newest)
            if row is None:
                raise RefusedError("There is no change to undo since the robot's runtime started.")
            if row.id != change:
                raise RefusedError("This is no longer the newest change. Look at the list, and try again.")
            values = _values(row)
            await self._send(
                ParametersCommand(
                    values={value.name: value.before for value in values},
                    expected={value.name: value.after for value in values},
                )
            )
            await self._note_undone(who, change)
        undone = [ChangedValue(name=value.name, before=value.after, after=value.before) for value in values]
        return Restored(changed=undone, left_out=[])

    @asynccontextmanager
    async def _turn(self) -> AsyncIterator[None]:
        """Wait for the turn among the commands, but not until the command would come as a surprise.

        Raise RuntimeSilentError.
        """
        try:
            async with asyncio.timeout(TURN_SECONDS):
                await self._order.acquire()
        except TimeoutError:
            raise RuntimeSilentError(BUSY, waited=False) from None
        try:
            yield
        finally:
            self._order.release()

    async def _send(self, command: RobotCommand) -> Mapping[str, Any]:
        answer = await self._bridge.command(command.policy.name, command.payload())
        values = {name: after for name, (_, after) in answer.get("changed", {}).items()}
        for listener in self.listeners:
            listener(values)
        return answer

    async def _note_groups(self) -> None:
        """Store the changes of open groups so far, so that the history stays in order."""
        for group in self._groups:
            await self._note_group(group)

    async def _note_group(self, group: _Group) -> None:
        changed = {name: pair for name, pair in group.changed.items() if pair[0] != pair[1]}
        group.changed = {}
        if changed:
            await self._note(group.who, group.why, changed)

    async def _note_undone(self, who: str, change: int) -> None:
        try:
            await self._store.write(
                lambda connection: connection.execute(
                    update(ParameterChangeRow).where(col(ParameterChangeRow.id) == change).values(undone=who)
                )
            )
        except StoreError as problem:
            # It is undone: were it the newest still, no change before it could be undone.
            self._undone[change] = who
            log.warning("the undoing of a change of parameters cannot be stored: %s", problem)

    def _undone_by(self, row: ParameterChangeRow) -> str:
        return row.undone or self._undone.get(row.id or 0, "")

    async def _note(self, who: str, why: str, changed: Mapping[str, tuple[Any, Any]]) -> None:
        row = ParameterChangeRow(
            time=time(),
            run=self._bridge.run,
            who=who,
            why=why,
            changed=json.dumps([value.model_dump() for value in _changed_values(changed)]),
        )
        try:
            await self._store.write(lambda connection: _insert(connection, row))
        except StoreError as problem:
            # The change is in force: a gap in the history is better than an answer that denies it.
            log.warning("a change of parameters cannot be stored: %s", problem)

    def _find_newest(self) -> ParameterChangeRow | None:
        mine = col(ParameterChangeRow.run) == self._bridge.run
        stored = col(ParameterChangeRow.undone) == "", col(ParameterChangeRow.id).not_in(self._undone)
        query = select(ParameterChangeRow).where(mine, *stored)
        with self._store.read() as database:
            return database.exec(query.order_by(desc(col(ParameterChangeRow.id))).limit(1)).first()


def _changed_values(changed: Mapping[str, tuple[Any, Any]]) -> list[ChangedValue]:
    return [ChangedValue(name=name, before=before, after=after) for name, (before, after) in changed.items()]


def _insert(connection: Connection, row: ParameterChangeRow) -> None:
    number = insert_row(connection, ParameterChangeRow, row.model_dump(exclude={"id"}))
    connection.execute(delete(ParameterChangeRow).where(col(ParameterChangeRow.id) <= number - CHANGES_MOST))


def _values(row: ParameterChangeRow) -> list[ChangedValue]:
    return [ChangedValue.model_validate(value) for value in json.loads(row.changed)]


def _show(row: ParameterChangeRow, undone: str, undoable: bool) -> Change:
    return Change(
        id=row.id or 0,
        time=datetime.fromtimestamp(row.time, UTC),
        who=row.who,
        why=row.why,
        values=_values(row),
        undone=undone,
        undoable=undoable,
    )
