"""Runs of the communication test in the database."""

import asyncio
import json
import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any, Literal, TypeVar

from sqlalchemy import Connection, insert, update
from sqlmodel import col, desc, select

from robot_runtime.comm_test.document import CommTest
from robot_runtime.comm_test.results import CellResult
from server import VERSION
from server.models import CommTestCell, CommTestRun
from server.store import Store

T = TypeVar("T")
End = Literal["complete", "cancelled", "failed"]


class Runs:
    """The runs in `store`. All methods raise StoreError and block until what they write is on the disk."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def start(self, test: CommTest, firmware: str, tools: dict[str, str]) -> int:
        """A run that begins now; its number."""
        values = {
            "name": test.name,
            "document": json.dumps(asdict(test), ensure_ascii=False),
            "framing": test.framing,
            "direction": test.direction,
            "cells": len(test.cells),
            "firmware": firmware,
            "tools": json.dumps(
                tools | {"mucat": VERSION, "python": platform.python_version()},
                ensure_ascii=False,
            ),
            "host": f"{platform.node()} {platform.system()} {platform.machine()}, emulated board",
            "started": time.time(),
            "state": "running",
            "problem": "",
        }
        return self._write(lambda connection: _insert_run(connection, values))

    def add(self, run: int, number: int, result: CellResult) -> None:
        """One cell that has been run."""
        values = _columns(result.values) | {"run_id": run, "number": number}
        self._write(lambda connection: connection.execute(insert(CommTestCell).values(values)))

    def end(self, run: int, state: End, problem: str = "") -> None:
        """The run is over."""
        changes = {"ended": time.time(), "state": state, "problem": problem}
        change = update(CommTestRun).where(col(CommTestRun.id) == run).values(changes)
        self._write(lambda connection: connection.execute(change))

    def mark_interrupted(self) -> None:
        """Runs that still say that they run were left by a program that was killed."""
        change = update(CommTestRun).where(col(CommTestRun.state) == "running").values(state="interrupted")
        self._write(lambda connection: connection.execute(change))

    def list(self) -> Sequence[CommTestRun]:
        """All runs, newest first."""
        with self._store.read() as database:
            return database.exec(select(CommTestRun).order_by(desc(col(CommTestRun.id)))).all()

    def find(self, run: int) -> CommTestRun | None:
        """A run; None where there is none of this number."""
        with self._store.read() as database:
            return database.get(CommTestRun, run)

    def cells(self, run: int) -> Sequence[CommTestCell]:
        """The cells of a run, in the order in which they were run."""
        with self._store.read() as database:
            wanted = select(CommTestCell).where(col(CommTestCell.run_id) == run)
            return database.exec(wanted.order_by(col(CommTestCell.number))).all()

    def _write(self, change: Callable[[Connection], T]) -> T:
        return asyncio.run(self._store.write(change))


def _insert_run(connection: Connection, values: dict[str, Any]) -> int:
    key = connection.execute(insert(CommTestRun).values(values)).inserted_primary_key
    assert key is not None
    return int(key[0])


def _columns(values: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if name in CommTestCell.model_fields}
