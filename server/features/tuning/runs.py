"""Tuning runs in the database. A change is on the disk when its method returns."""

import json
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, delete, select, update
from sqlmodel import col
from sqlmodel import select as select_rows

from robot_runtime.contract.limits import LoopName
from server.features.tuning.curve import TuningCurve
from server.features.tuning.rules import propose
from server.features.tuning.schemas import (
    ControllerInForce,
    RelayStart,
    RunState,
    StepStart,
    TuningRun,
    TuningRunDetail,
)
from server.platform.errors import NotFoundError
from server.platform.models import TuningRunRow
from server.platform.store import Store, insert_row
from server.recording.session import SessionStateError

LISTED_MOST = 500


class UnknownTuningRunError(NotFoundError):
    """There is no such run"""

    def __init__(self, run: int) -> None:
        super().__init__(f"There is no run {run}; it may have been deleted.")


class TuningStore:
    """All runs, stored until they are deleted. Methods raise StoreError, and UnknownTuningRunError."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def list(self, loop: LoopName) -> Sequence[TuningRun]:
        """Return the runs on this loop without their curves, the newest first."""
        columns = [column for column in TuningRunRow.__table__.columns if column.name != "curve"]  # type: ignore[attr-defined]
        query = select(*columns).where(col(TuningRunRow.loop) == loop)
        newest = query.order_by(col(TuningRunRow.id).desc()).limit(LISTED_MOST)
        with self._store.read() as database:
            rows = database.execute(newest).mappings().all()
        return [TuningRun(**_summarize(TuningRunRow(**row, curve=b""))) for row in rows]

    def detail(self, run: int) -> TuningRunDetail:
        """Return one run with its curve."""
        with self._store.read() as database:
            row = database.exec(select_rows(TuningRunRow).where(col(TuningRunRow.id) == run)).one_or_none()
        if row is None:
            raise UnknownTuningRunError(run)
        shown = TuningRun(**_summarize(row))
        limits = json.loads(row.parameters)["limits"]
        proposals = [] if shown.cycle is None else propose(shown.loop, shown.cycle, limits)
        return TuningRunDetail(
            **dict(shown),
            curve=TuningCurve.from_bytes(row.curve),
            proposals=proposals,
        )

    async def begin(
        self, experiment: StepStart | RelayStart, name: str, force: ControllerInForce, limits: Any
    ) -> int:
        """Add a run that begins now, and return its number; `limits` are those of the PID's gains."""
        values = {
            "name": name,
            "kind": experiment.kind,
            "loop": experiment.loop,
            "started": time.time(),
            "state": "running",
            "problem": "",
            "settings": experiment.model_dump_json(),
            "parameters": json.dumps({**force.model_dump(), "limits": limits}),
            "figures": "{}",
            "curve": b"",
        }
        return await self._store.write(lambda connection: insert_row(connection, TuningRunRow, values))

    async def end(
        self, run: int, state: RunState, problem: str, results: dict[str, Any], curve: TuningCurve
    ) -> None:
        """Store the end of a run and its results, in one transaction."""
        values = {
            "state": state,
            "problem": problem,
            "figures": json.dumps(results),
            "curve": curve.to_bytes(),
        }
        await self._store.execute(update(TuningRunRow).where(col(TuningRunRow.id) == run).values(values))

    async def rename(self, run: int, name: str) -> None:
        """Rename a run."""
        change = update(TuningRunRow).where(col(TuningRunRow.id) == run).values(name=name)
        if await self._store.execute(change) == 0:
            raise UnknownTuningRunError(run)

    async def delete(self, run: int) -> None:
        """Remove a run for good. Raise SessionStateError while it runs."""

        def change(connection: Connection) -> None:
            state = connection.execute(
                select(col(TuningRunRow.state)).where(col(TuningRunRow.id) == run)
            ).scalar_one_or_none()
            if state is None:
                raise UnknownTuningRunError(run)
            if state == "running":
                raise SessionStateError("This run is active. Stop it first.")
            connection.execute(delete(TuningRunRow).where(col(TuningRunRow.id) == run))

        await self._store.write(change, frees=True)

    async def forget(self, run: int) -> None:
        """Remove a run that could not start."""
        await self._store.execute(delete(TuningRunRow).where(col(TuningRunRow.id) == run))

    async def mark_interrupted(self) -> None:
        """Mark the running runs of a killed server as interrupted."""
        values = {"state": "interrupted", "problem": "The server ended during the run; its curve is lost."}
        running = col(TuningRunRow.state) == "running"
        await self._store.execute(update(TuningRunRow).where(running).values(values))


def _summarize(row: TuningRunRow) -> dict[str, Any]:
    stored = json.loads(row.figures)
    force = json.loads(row.parameters)
    return {
        **row.model_dump(include={"id", "name", "kind", "loop", "state", "problem"}),
        "started": datetime.fromtimestamp(row.started, UTC),
        "settings": json.loads(row.settings),
        "force": {name: force[name] for name in ControllerInForce.model_fields},
        "figures": stored.get("figures", {}),
        "cycle": stored.get("cycle"),
    }
