"""The plug of sessions: recording, and what becomes of recordings."""

import asyncio
import json
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import SENT_BY, STATE
from robot_runtime.control.alarms import Alarms
from robot_runtime.transport.blocks import Block
from server.feature import Plug
from server.features.sessions.auto_recording import AutoRecorder
from server.features.sessions.catalogue import Catalogue
from server.features.sessions.clock_correction import ClockCorrection
from server.features.sessions.config import SessionsConfig
from server.features.sessions.provenance import ProvenanceWatch
from server.features.sessions.recorder import Recorder, RecordingRefusedError
from server.features.sessions.resume import find_missing
from server.features.sessions.retention import RetentionWorker
from server.features.sessions.session import new_row
from server.health.occupation import Occupation
from server.health.plug import ServerStart
from server.http.audit import ARMING, AuditLog
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.pidfile import running_parts
from server.platform.settings import Settings
from server.platform.store import Store, StoreError
from server.processes.supervisor import ProcessSupervisor
from server.services import Maker
from server.stream.bridge import Bridge
from server.stream.feed import Feed
from server.stream.hub import Hub

TICK_SECONDS = 1.0


def make_provenance(settings: Settings, bridge: Bridge, notices: Notices) -> ProvenanceWatch:
    """Follows what the robot runs by."""
    return ProvenanceWatch(settings, lambda: bridge.query("provenance"), notices)


def make_recorder(
    store: Store, clock: Clock, notices: Notices, hub: Hub, provenance: ProvenanceWatch
) -> Recorder:
    """Records, and sends the pages every change of the session that records."""
    recorder = Recorder(store, clock, notices, lambda: announce(recorder, hub), provenance)
    return recorder


def announce(recorder: Recorder, hub: Hub) -> None:
    """Send the pages the session that records."""
    session = recorder.session
    hub.notify({"op": "session", "recording": session and json.loads(session.model_dump_json())})


def make_catalogue(store: Store, recorder: Recorder) -> Catalogue:
    """The list of sessions."""
    return Catalogue(store, recorder)


def make_clock_correction(
    store: Store, notices: Notices, clock: Clock, catalogue: Catalogue
) -> ClockCorrection:
    """Corrects the dates of sessions."""
    return ClockCorrection(store, notices, clock, catalogue.notify)


def make_auto_recorder(
    settings: Settings, recorder: Recorder, clock: Clock, notices: Notices
) -> AutoRecorder:
    """Records while the robot is armed."""

    async def make_row(name: str, state: str) -> SessionRow:
        return await asyncio.to_thread(new_row, settings, clock, name, "", state, origin="arming")

    return AutoRecorder(recorder, clock, notices, make_row)


class SessionsPlug(Plug):
    """Records, goes on with the recording of a killed server, and ends it with the server."""

    makers: ClassVar[tuple[Maker, ...]] = (
        make_provenance,
        make_recorder,
        make_catalogue,
        make_clock_correction,
        make_auto_recorder,
    )

    def __init__(
        self,
        settings: Settings,
        recorder: Recorder,
        arming: AutoRecorder,
        provenance: ProvenanceWatch,
        retention: RetentionWorker,
        correction: ClockCorrection,
        processes: ProcessSupervisor,
        occupation: Occupation,
        bridge: Bridge,
        feed: Feed,
        hub: Hub,
        audit: AuditLog,
        notices: Notices,
        alarms: Alarms,
        server: ServerStart,
    ) -> None:
        self._alarms = alarms
        self._ended = server.ended
        self._settings = settings
        self._recorder = recorder
        self._arming = arming
        self._provenance = provenance
        self._retention = retention
        self._correction = correction
        self._processes = processes
        self._bridge = bridge
        self._hub = hub
        self._notices = notices
        occupation.board.append(self._explain)
        feed.listen(recorder.add)
        feed.listen(lambda _: provenance.see_run(bridge.run), STATE)
        if settings.section(SessionsConfig).record_at_arming:
            feed.listen_to_rounds(self._see_states)
            audit.notice = self._note_act

    async def start(self) -> None:
        """Take in what the parts of a killed server have sent since."""
        interrupted = await self._recorder.recover()
        running = set(running_parts(self._settings.data.run))
        if "runtime" in running and self._settings.in_the_loop:
            running.add("simulator")  # perhaps on another computer
        backlogs = await self._bridge.catch_up(running)
        if interrupted is not None:
            found = {name: find_missing(interrupted, SENT_BY[name], one) for name, one in backlogs.items()}
            await self._recorder.resume(interrupted, found)
        self._bridge.begin_delivery(backlogs)
        self._recorder.caught_up()
        announce(self._recorder, self._hub)
        if self._ended:
            self._alarms.begin("server_restarted", f"{self._ended} It was started again.")
        with suppress(StoreError):
            # Killed again at once, it has stored its restart. The watchdog tells of a failure.
            await self._recorder.flush()

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Store, remove, correct."""
        return (
            self._recorder.run(),
            self._retention.run(),
            self._correction.run(),
            self._provenance.run(),
            self._tick(),
        )

    async def close(self) -> None:
        """End the session."""
        await self._arming.close()
        if self._recorder.session is not None:
            # Where even its end cannot be stored, the next start marks it as interrupted.
            with suppress(StoreError, RecordingRefusedError):
                await self._recorder.stop(self._recorder.session.id)

    async def _tick(self) -> None:
        while True:
            self._arming.tick()
            board = self._processes.get("board")
            await self._provenance.see_board(None if board is None else board.pid)
            await asyncio.sleep(TICK_SECONDS)

    def _see_states(self, blocks: Sequence[Block]) -> None:
        if states := [block for block in blocks if block.topic is STATE]:
            self._arming.see(states)

    def _note_act(self, operation: str, text: str) -> None:
        if operation in ARMING:
            self._arming.note_arming(text)
        else:
            self._notices.notify("control", "info", text)

    def _explain(self) -> str | None:
        session = self._recorder.session
        # An automatic recording ends by itself: reserving the board disarms the robot.
        if session is None or session.origin == "arming":
            return None
        return f"“{session.name}” is being recorded. Stop the recording first."
