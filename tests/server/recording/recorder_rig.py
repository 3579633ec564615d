"""A recorder with a clock, a database and notices."""

import json
import sqlite3

import pytest
from sqlalchemy.exc import OperationalError
from sqlmodel import col, select

import server.recording.recorder as recorder_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import NUMBERS, Block
from server.platform.models import Chunk, Gap
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import new_row


class RecorderRig:
    """A recorder and everything around it."""

    def __init__(self, store: Store, settings: Settings) -> None:
        self.store = store
        self.settings = settings
        self.clock = SimulatedClock(50.0)
        self.notice_texts: list[str] = []
        self.changes = 0
        self._with_notices = False
        self.recorder = Recorder(store, self.clock, Notices(self.clock, self._hear), self._count)

    async def start(self, name: str = "dive") -> int:
        row = new_row(self.settings, self.clock, name, "", "null")
        return (await self.recorder.start(row)).id

    def chunks(self, topic: str = "depth") -> list[Chunk]:
        with self.store.read() as database:
            return list(
                database.exec(select(Chunk).where(Chunk.topic == topic).order_by(col(Chunk.id))).all()
            )

    def numbers(self, topic: str = "depth") -> list[int]:
        return [
            (chunk.first + position) % NUMBERS
            for chunk in self.chunks(topic)
            for position in range(chunk.count)
        ]

    def gaps(self) -> list[tuple[str, str, int]]:
        with self.store.read() as database:
            return [
                (gap.topic, gap.kind, gap.missed) for gap in database.exec(select(Gap).order_by(col(Gap.id)))
            ]

    def fail(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Make every write fail from here on, as on a full disk."""
        problem = sqlite3.OperationalError("database or disk is full")

        def refuse(*_: object) -> None:
            raise OperationalError("INSERT", {}, problem)

        monkeypatch.setattr(recorder_module, "_insert", refuse)

    def record_notices(self) -> None:
        """Record notices, as the server does."""
        self._with_notices = True

    def _hear(self, arrival: Block) -> None:
        self.notice_texts.append(json.loads(arrival.payload)[0]["text"])
        if self._with_notices:
            self.recorder.add(arrival)

    def _count(self) -> None:
        self.changes += 1
