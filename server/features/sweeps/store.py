"""Sweeps in the database: their rows, their runs, and figures by key."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import time
from typing import Any

from sqlalchemy import Connection, Select, delete, func, update
from sqlmodel import col, desc, select

from robot_runtime.experiments.sweep.parameter import Value
from server.features.sweeps.run_task import RunOutcome, WorkerIdentity
from server.platform.errors import NotFoundError
from server.platform.models import RunFiguresRow, SessionRow, SweepRow, SweepRunRow
from server.platform.store import Reader, Store, insert_row, insert_unless_there

SWEEPS_MAX = 500
LISTED_MAX = 200
KEYS_AT_ONCE = 500
_FIGURES: tuple[Any, ...] = (
    RunFiguresRow.key,
    RunFiguresRow.problem,
    RunFiguresRow.simulated,
    RunFiguresRow.seconds,
    RunFiguresRow.figures,
    RunFiguresRow.words,
)
_RUNS: tuple[Any, ...] = (
    SweepRunRow.number,
    SweepRunRow.variant,
    SweepRunRow.seed,
    SweepRunRow.parameter_values,
    *_FIGURES,
)


class UnknownSweepError(NotFoundError):
    """There is no such sweep"""

    def __init__(self, sweep: int) -> None:
        super().__init__(f"There is no sweep {sweep}; choose one from the list of sweeps.")


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A run that is done."""

    number: int
    variant: int
    seed: int
    values: tuple[Value, ...]
    outcome: RunOutcome


def find_outcomes(store: Reader, keys: Sequence[str]) -> dict[str, RunOutcome]:
    """Return the stored outcomes among these keys. Raise StoreError."""
    outcomes: dict[str, RunOutcome] = {}
    with store.read() as database:
        for at in range(0, len(keys), KEYS_AT_ONCE):
            some = keys[at : at + KEYS_AT_ONCE]
            rows = database.connection().execute(select(*_FIGURES).where(col(RunFiguresRow.key).in_(some)))
            outcomes |= {row.key: _read_outcome(row) for row in rows}
    return outcomes


def find_rate(store: Reader, identity: WorkerIdentity) -> float | None:
    """Return the s that a simulated second takes by the runs of this software; None before the first."""
    query = select(func.sum(RunFiguresRow.seconds), func.sum(RunFiguresRow.simulated)).where(
        RunFiguresRow.software == identity.software, RunFiguresRow.simulated > 0
    )
    with store.read() as database:
        seconds, simulated = database.connection().execute(query).one()
    return seconds / simulated if simulated else None


class SweepStore:
    """The sweeps of a database. Methods raise StoreError; those that read block."""

    def __init__(self, store: Store) -> None:
        self.reader: Reader = store
        self._store = store

    async def add(self, row: SweepRow) -> int:
        """Store a new sweep and return its number; beyond SWEEPS_MAX the oldest ended ones are removed."""
        values = row.model_dump(exclude={"id"})

        def write(connection: Connection) -> int:
            number = insert_row(connection, SweepRow, values)
            ended = select(SweepRow.id).where(col(SweepRow.state).not_in(("running", "waiting")))
            newest = select(SweepRow.id).order_by(desc(col(SweepRow.id))).limit(SWEEPS_MAX)
            for (old,) in connection.execute(ended.where(col(SweepRow.id).not_in(newest))).all():
                _remove(connection, old)
            return number

        return await self._store.write(write)

    async def change(self, sweep: int, **values: Any) -> None:
        """Change columns of a sweep."""
        await self._store.execute(update(SweepRow).where(col(SweepRow.id) == sweep).values(**values))

    async def interrupt(self) -> None:
        """Mark the sweeps of a killed server."""
        active = col(SweepRow.state).in_(("running", "waiting"))
        await self._store.execute(update(SweepRow).where(active).values(state="interrupted", ended=time()))

    async def forget(self, software: str) -> None:
        """Remove the figures of other software that no sweep has: nobody looks them up."""
        named = select(SweepRunRow.key).where(col(SweepRunRow.key) == col(RunFiguresRow.key)).exists()
        other = col(RunFiguresRow.software) != software
        await self._store.execute(delete(RunFiguresRow).where(other, ~named))

    async def remove(self, sweep: int) -> None:
        """Remove a sweep; the figures stay, as other sweeps may share them."""
        await self._store.write(lambda connection: _remove(connection, sweep), frees=True)

    async def keep(
        self, sweep: int, identity: WorkerIdentity, runs: Sequence[StoredRun], progress: dict[str, Any]
    ) -> None:
        """Store runs with their figures, and the sweep's progress, in one transaction."""
        figures = [
            {
                "key": _stored_key(sweep, run.outcome),
                "firmware": identity.firmware,
                "software": identity.software,
                "simulated": run.outcome.simulated,
                "seconds": run.outcome.seconds,
                "problem": run.outcome.problem,
                "figures": json.dumps(run.outcome.figures, allow_nan=False),
                "words": json.dumps(run.outcome.words, ensure_ascii=False),
            }
            for run in runs
        ]
        rows = [
            {
                "sweep_id": sweep,
                "number": run.number,
                "variant": run.variant,
                "seed": run.seed,
                "parameter_values": json.dumps(run.values),
                "key": _stored_key(sweep, run.outcome),
            }
            for run in runs
        ]

        def write(connection: Connection) -> None:
            if rows:
                added = insert_unless_there(connection, RunFiguresRow)
                connection.execute(added.on_conflict_do_nothing(), figures)
                replaced = insert_unless_there(connection, SweepRunRow)
                columns = ("variant", "seed", "parameter_values", "key")
                replaced = replaced.on_conflict_do_update(
                    index_elements=["sweep_id", "number"],
                    set_={name: replaced.excluded[name] for name in columns},
                )
                connection.execute(replaced, rows)
            connection.execute(update(SweepRow).where(col(SweepRow.id) == sweep).values(**progress))

        await self._store.write(write)

    def find(self, sweep: int) -> SweepRow:
        """Return a sweep. Raise UnknownSweepError."""
        with self.reader.read() as database:
            row = database.get(SweepRow, sweep)
        if row is None:
            raise UnknownSweepError(sweep)
        return row

    def newest(self) -> list[SweepRow]:
        """Return the newest sweeps, newest first."""
        with self.reader.read() as database:
            query = select(SweepRow).order_by(desc(col(SweepRow.id))).limit(LISTED_MAX)
            return list(database.exec(query))

    def some(self, sweeps: Sequence[int]) -> list[SweepRow]:
        """Return these sweeps in this order; unknown ones are left out."""
        with self.reader.read() as database:
            rows = {
                row.id: row for row in database.exec(select(SweepRow).where(col(SweepRow.id).in_(sweeps)))
            }
        return [rows[sweep] for sweep in sweeps if sweep in rows]

    def runs(self, sweep: int, variant: int | None = None) -> list[StoredRun]:
        """Return the runs that are done, by their numbers; with `variant` only those of one."""
        return [*read_runs(self.reader, sweep, variant)]

    def sessions(self, name: str) -> dict[str, int]:
        """Return the sessions of a scenario in simulated time, by the scenario's text."""
        query = select(SessionRow.scenario, SessionRow.id).where(
            col(SessionRow.scenario_name) == name,
            col(SessionRow.origin) == "simulated",
            col(SessionRow.state) == "complete",
            col(SessionRow.deleted).is_(None),
        )
        with self.reader.read() as database:
            rows = database.connection().execute(query.order_by(col(SessionRow.id)))
            return {text: number for text, number in rows if number is not None}


def read_runs(store: Reader, sweep: int, variant: int | None = None) -> Iterator[StoredRun]:
    """Yield the runs of a sweep that are done, by their numbers. Raise StoreError."""
    query: Select[Any] = (
        select(*_RUNS)
        .join(RunFiguresRow, col(RunFiguresRow.key) == col(SweepRunRow.key))
        .where(col(SweepRunRow.sweep_id) == sweep)
        .order_by(col(SweepRunRow.number))
    )
    if variant is not None:
        query = query.where(col(SweepRunRow.variant) == variant)
    with store.read() as database:
        rows = database.connection().execute(query).all()
    for row in rows:
        values = tuple(json.loads(row.parameter_values))
        yield StoredRun(row.number, row.variant, row.seed, values, _read_outcome(row))


def _read_outcome(row: Any) -> RunOutcome:
    return RunOutcome(
        key=row.key,
        problem=row.problem,
        simulated=row.simulated,
        seconds=row.seconds,
        figures=json.loads(row.figures),
        words=json.loads(row.words),
    )


def _stored_key(sweep: int, outcome: RunOutcome) -> str:
    # Under a key that nobody looks up: it is tried again when the sweep is resumed.
    return outcome.key if outcome.lasting else f"{outcome.key} failed in {sweep}"


def _remove(connection: Connection, sweep: int) -> None:
    connection.execute(delete(SweepRunRow).where(col(SweepRunRow.sweep_id) == sweep))
    connection.execute(delete(SweepRow).where(col(SweepRow.id) == sweep))
