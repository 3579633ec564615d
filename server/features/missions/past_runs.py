"""The earlier runs of a mission: those that sessions recorded."""

from dataclasses import replace

from sqlmodel import col, select

from robot_runtime.contract.topics import MISSION
from server.features.missions.schemas import PastMissionRun
from server.library.content import Recording, RecordingError
from server.library.missions import RecordedMission, read_missions
from server.platform.models import Chunk, SessionRow
from server.platform.store import Store
from server.recording.session import HIDDEN, from_row

RUNS_MAX = 12
SESSIONS_MAX = 200
"""Sessions that are searched, the newest ones with missions."""


class PastMissionRuns:
    """The reader of earlier runs. What it has read of a session that has ended is remembered."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._known: dict[int, list[RecordedMission]] = {}

    def find(self, name: str) -> list[PastMissionRun]:
        """Return the last runs of the mission of this name, the newest first; `RUNS_MAX` at most.

        Sessions that cannot be read are left out. Raise StoreError.
        """
        runs: list[PastMissionRun] = []
        for row in self._sessions():
            missions = reversed(self._missions(row))
            runs += [_describe(row, mission) for mission in missions if mission.mission.name == name]
            if len(runs) >= RUNS_MAX:
                break
        return runs[:RUNS_MAX]

    def _sessions(self) -> list[SessionRow]:
        held = select(Chunk.id).where(Chunk.session_id == SessionRow.id, Chunk.topic == MISSION.name).exists()
        query = select(SessionRow).where(
            held,
            col(SessionRow.state).not_in(HIDDEN),
            col(SessionRow.deleted).is_(None),
        )
        with self._store.read() as database:
            rows = database.exec(query.order_by(col(SessionRow.id).desc()).limit(SESSIONS_MAX)).all()
        return list(rows)

    def _missions(self, row: SessionRow) -> list[RecordedMission]:
        assert row.id is not None
        if row.id in self._known:
            return self._known[row.id]
        try:
            missions, _ = read_missions(Recording(self._store, row))
        except RecordingError:
            return []
        missions = [_without_steps(mission) for mission in missions]
        if row.state != "recording":
            self._known[row.id] = missions
        return missions


def _without_steps(read: RecordedMission) -> RecordedMission:
    """Return a mission without its steps and text, which would fill the memory."""
    mission = replace(read.mission, steps=[], document="")
    return read.model_copy(update={"mission": mission, "document": "", "started": []})


def _describe(row: SessionRow, mission: RecordedMission) -> PastMissionRun:
    last = mission.mission
    return PastMissionRun(
        session=from_row(row),
        start=mission.start,
        end=mission.end,
        phase=last.phase,
        text=last.text,
        elapsed=last.elapsed,
        deepest=last.deepest,
    )
