"""The plug of recording at arming."""

import asyncio
from collections.abc import Coroutine, Sequence
from typing import Any, ClassVar

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import STATE
from robot_runtime.transport.blocks import Block
from server.feature import Plug
from server.http.audit import ARMING, AuditLog
from server.library.config import SessionsConfig
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.recording.auto_recording import AutoRecorder
from server.recording.recorder import TICK_SECONDS, Recorder
from server.recording.session import new_row
from server.services import Maker
from server.stream.feed import Feed


def make_auto_recorder(
    settings: Settings, recorder: Recorder, clock: Clock, notices: Notices
) -> AutoRecorder:
    """Return the automatic recorder."""

    async def make_row(name: str, state: str) -> SessionRow:
        return await asyncio.to_thread(new_row, settings, clock, name, "", state, origin="arming")

    return AutoRecorder(recorder, clock, notices, make_row)


class ArmingPlug(Plug):
    """The plug that begins and ends the sessions of arming."""

    makers: ClassVar[tuple[Maker, ...]] = (make_auto_recorder,)

    def __init__(
        self, settings: Settings, arming: AutoRecorder, feed: Feed, audit: AuditLog, notices: Notices
    ) -> None:
        self._arming = arming
        self._notices = notices
        if settings.section(SessionsConfig).record_at_arming:
            feed.listen_to_rounds(self._see_states)
            audit.notice = self._note_act

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """End the session when it is due."""
        return (self._tick(),)

    async def close(self) -> None:
        """Wait for a start or stop in progress."""
        await self._arming.close()

    async def _tick(self) -> None:
        while True:
            self._arming.tick()
            await asyncio.sleep(TICK_SECONDS)

    def _see_states(self, blocks: Sequence[Block]) -> None:
        if states := [block for block in blocks if block.topic is STATE]:
            self._arming.see(states)

    def _note_act(self, operation: str, text: str) -> None:
        if operation in ARMING:
            self._arming.note_arming(text)
        else:
            self._notices.notify("control", "info", text)
