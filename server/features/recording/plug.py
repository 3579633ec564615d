"""The plug of recording: samples are stored from the start of a session to its end."""

import asyncio
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from typing import Any

from robot_runtime.contract.topics import SENT_BY, STATE
from robot_runtime.control.alarms import Alarms
from server.feature import Plug
from server.health.occupation import Occupation
from server.health.plug import ServerStart
from server.platform.pidfile import running_parts
from server.platform.settings import Settings
from server.platform.store import StoreError
from server.processes.supervisor import ProcessSupervisor
from server.recording.plug import announce
from server.recording.provenance import ProvenanceWatch
from server.recording.recorder import TICK_SECONDS, Recorder, RecordingRefusedError
from server.recording.resume import find_missing
from server.stream.bridge import Bridge
from server.stream.feed import Feed
from server.stream.hub import Hub


class RecordingPlug(Plug):
    """The plug that records, continues a killed server's recording, and ends it with the server."""

    def __init__(
        self,
        settings: Settings,
        recorder: Recorder,
        provenance: ProvenanceWatch,
        processes: ProcessSupervisor,
        occupation: Occupation,
        bridge: Bridge,
        feed: Feed,
        hub: Hub,
        alarms: Alarms,
        server: ServerStart,
    ) -> None:
        self._alarms = alarms
        self._ended = server.ended
        self._settings = settings
        self._recorder = recorder
        self._provenance = provenance
        self._processes = processes
        self._bridge = bridge
        self._hub = hub
        occupation.board.append(self._explain)
        feed.listen(recorder.add)
        feed.listen(lambda _: provenance.see_run(bridge.run), STATE)

    async def start(self) -> None:
        """Record the samples since the end of a killed server."""
        interrupted = await self._recorder.recover()
        running = set(running_parts(self._settings.data.run))
        if "runtime" in running and self._settings.in_the_loop:
            running.add("simulator")  # perhaps on another computer
        backlogs = await self._bridge.catch_up(running)
        if interrupted is not None:
            missing = {
                name: find_missing(interrupted, SENT_BY[name], backlog) for name, backlog in backlogs.items()
            }
            await self._recorder.resume(interrupted, missing)
        self._bridge.begin_delivery(backlogs)
        self._recorder.caught_up()
        announce(self._recorder, self._hub)
        if self._ended:
            self._alarms.begin("server_restarted", f"{self._ended} It was started again.")
        with suppress(StoreError):
            # Killed again at once, it has stored its restart. The watchdog tells of a failure.
            await self._recorder.flush()

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Store arriving samples."""
        return (self._recorder.run(), self._provenance.run(), self._see_board())

    async def close(self) -> None:
        """End the session."""
        if self._recorder.session is not None:
            # Where even its end cannot be stored, the next start marks it as interrupted.
            with suppress(StoreError, RecordingRefusedError):
                await self._recorder.stop(self._recorder.session.id)

    async def _see_board(self) -> None:
        while True:
            board = self._processes.get("board")
            await self._provenance.see_board(None if board is None else board.pid)
            await asyncio.sleep(TICK_SECONDS)

    def _explain(self) -> str | None:
        session = self._recorder.session
        # An automatic recording ends by itself: reserving the board disarms the robot.
        if session is None or session.origin == "arming":
            return None
        return f"“{session.name}” is being recorded. Stop the recording first."
