"""Runs of the communication test in the database."""

import json
import platform
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any, Literal

from sqlalchemy import Connection, insert, update
from sqlmodel import col, desc, func, select

from robot_runtime.experiments.comm_test.document import CommTest
from server import VERSION
from server.features.comm_tests.schemas import Cell, CommTestRunDetails, Place, RunSummary
from server.platform.errors import NotFoundError
from server.platform.models import CommTestCell, CommTestRun
from server.platform.store import Reader, Store, insert_row

LISTED_MOST = 500

End = Literal["complete", "cancelled", "failed"]


class UnknownCommTestRunError(NotFoundError):
    """There is no such run"""


class CommTestRuns:
    """Read access to the runs of a database. All methods raise StoreError."""

    def __init__(self, store: Reader) -> None:
        self._reader = store

    def list(self) -> Sequence[CommTestRun]:
        """Return all runs, newest first."""
        with self._reader.read() as database:
            return database.exec(select(CommTestRun).order_by(desc(col(CommTestRun.id)))).all()

    def find(self, run: int) -> CommTestRun:
        """Return a run. Raise UnknownCommTestRunError."""
        with self._reader.read() as database:
            row = database.get(CommTestRun, run)
        if row is None:
            raise UnknownCommTestRunError(f"There is no run {run}; choose one from the list of runs.")
        return row

    def cells(self, run: int) -> Sequence[CommTestCell]:
        """Return the cells of a run, in the order in which they were run."""
        with self._reader.read() as database:
            query = select(CommTestCell).where(col(CommTestCell.run_id) == run)
            return database.exec(query.order_by(col(CommTestCell.number))).all()

    def summaries(self) -> Sequence[RunSummary]:
        """Return the newest runs with their figures, newest first; at most `LISTED_MOST`."""
        newest = select(CommTestRun).order_by(desc(col(CommTestRun.id))).limit(LISTED_MOST)
        figures = select(
            col(CommTestCell.run_id),
            func.count(),
            func.avg(col(CommTestCell.rate)),
            func.min(col(CommTestCell.rate)),
        ).group_by(col(CommTestCell.run_id))
        with self._reader.read() as database:
            runs = database.exec(newest).all()
            shown = col(CommTestCell.run_id).in_([run.id for run in runs])
            known = {run: (count, mean, low) for run, count, mean, low in database.exec(figures.where(shown))}
            return [RunSummary(**_summary(run, *known.get(run.id or 0, (0, None, None)))) for run in runs]

    def whole(self, run: CommTestRun) -> CommTestRunDetails:
        """Return a run with its configuration and its cells."""
        cells = [_cell(cell) for cell in self.cells(run.id or 0)]
        rates = [cell.rate for cell in cells]
        mean, low = (sum(rates) / len(rates), min(rates)) if rates else (None, None)
        return CommTestRunDetails(
            **_summary(run, len(cells), mean, low),
            document=json.loads(run.document),
            firmware=run.firmware,
            tools=json.loads(run.tools),
            host=run.host,
            results=cells,
        )


class CommTestStore(CommTestRuns):
    """Write access to the runs. A change is on the disk when its method returns."""

    def __init__(self, store: Store) -> None:
        super().__init__(store)
        self._store = store

    async def start(
        self, test: CommTest, board: Place, firmware: str, tools: Mapping[str, str], host: str
    ) -> int:
        """Add a run that begins now, and return its number."""
        values = {
            "name": test.name,
            "document": json.dumps(asdict(test), ensure_ascii=False),
            "framing": test.framing,
            "direction": test.direction,
            "cells": len(test.cells),
            "firmware": firmware,
            "tools": json.dumps(
                {**tools, "mucat": VERSION, "python": platform.python_version()}, ensure_ascii=False
            ),
            "host": host,
            "started": time.time(),
            "state": "running",
            "problem": "",
            "place": board,
            "sample": "",
        }
        return await self._store.write(lambda connection: insert_row(connection, CommTestRun, values))

    async def add(self, run: int, number: int, values: Mapping[str, Any]) -> Cell:
        """Store a cell as the test process reports it. Raise ValueError if it is not valid."""
        cell = CommTestCell.model_validate({**values, "run_id": run, "number": number})
        await self._store.execute(insert(CommTestCell).values(cell.model_dump(exclude={"id"})))
        return _cell(cell)

    async def end(self, run: int, state: End, problem: str = "") -> None:
        """Store the end of a run."""
        changes = {"ended": time.time(), "state": state, "problem": problem}
        await self._store.execute(update(CommTestRun).where(col(CommTestRun.id) == run).values(changes))

    async def mark_interrupted(self) -> None:
        """Mark the running runs of a killed program as interrupted."""
        changes = {"state": "interrupted", "problem": "The program ended while the test ran."}
        running = col(CommTestRun.state) == "running"
        await self._store.execute(update(CommTestRun).where(running).values(changes))

    async def add_sample(self, run: Mapping[str, Any], cells: Sequence[Mapping[str, Any]]) -> None:
        """Add a shipped run with its cells, in one transaction; columns by name."""

        def change(connection: Connection) -> None:
            number = insert_row(connection, CommTestRun, run)
            connection.execute(insert(CommTestCell), [{**cell, "run_id": number} for cell in cells])

        await self._store.write(change)


def _summary(run: CommTestRun, done: int, mean: float | None, low: float | None) -> dict[str, Any]:
    values = run.model_dump(include=set(RunSummary.model_fields) - {"started", "ended"})
    return {
        **values,
        "started": datetime.fromtimestamp(run.started, UTC),
        "ended": None if run.ended is None else datetime.fromtimestamp(run.ended, UTC),
        "cells_done": done,
        "rate_mean": mean,
        "rate_min": low,
    }


def _cell(cell: CommTestCell) -> Cell:
    values = cell.model_dump(include=set(Cell.model_fields) - {"causes"})
    causes = [cause for cause in cell.causes.split(", ") if cause]
    return Cell(**values, causes=causes, reasons=cell.explanation.splitlines())
