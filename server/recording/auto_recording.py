"""Automatic recording while the robot is armed."""

import asyncio
import json
import logging
from collections.abc import Awaitable, Callable, Sequence
from datetime import UTC, datetime

from robot_runtime.clock import Clock
from robot_runtime.transport.blocks import Block
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.store import StoreError
from server.recording.recorder import Recorder, RecordingRefusedError
from server.recording.session import default_name

log = logging.getLogger(__name__)

REST_SECONDS = 5.0
"""Time that it records after the robot is disarmed, until the fins rest and the robot begins to rise."""

ARMING_SECONDS = 2.0
"""Longest wait of the notice of who armed, for the session to begin; then it is written all the same."""


class AutoRecorder:
    """Recorder that starts a session when the robot is armed, and stops it after the robot is disarmed.

    `make_row` makes the session from a name and the robot's state. A session that arming started under an
    earlier server is stopped in the same way.
    """

    def __init__(
        self,
        recorder: Recorder,
        clock: Clock,
        notices: Notices,
        make_row: Callable[[str, str], Awaitable[SessionRow]],
    ) -> None:
        self._recorder = recorder
        self._clock = clock
        self._notices = notices
        self._make_row = make_row
        self._armed = False
        self._disarmed_at: float | None = None
        self._task: asyncio.Task[None] | None = None
        self._armed_by = ""
        self._armed_by_at = 0.0

    def note_arming(self, text: str) -> None:
        """Write a notice with the person who armed the robot, once its session has begun."""
        self._armed_by, self._armed_by_at = text, self._clock.now()
        if self._recorder.session is not None:
            self._write_arming()

    def see(self, states: Sequence[Block]) -> None:
        """Process blocks of the topic `state` that arrived together; the newest counts.

        The others of a backlog belong to the past, which can no longer be recorded.
        """
        try:
            state = json.loads(states[-1].payload)[-1]
            armed = state["armed"] is True
        except (ValueError, LookupError, TypeError, RecursionError):
            return
        if armed:
            self._disarmed_at = None
            if not self._armed and (self._acts or self._recorder.stopping):
                # A session is being ended, perhaps, and the next state begins another.
                return
            if not self._armed and self._recorder.session is None:
                self._act(self._begin(json.dumps(state)))
        elif self._armed or self._disarmed_at is None:
            self._disarmed_at = self._clock.now()
            self._write_arming()
        self._armed = armed

    def tick(self) -> None:
        """Stop the session when it is due; called about every second."""
        if self._clock.now() - self._armed_by_at >= ARMING_SECONDS:
            self._write_arming()
        session = self._recorder.session
        if session is None or session.origin != "arming" or self._disarmed_at is None:
            return
        if self._clock.now() - self._disarmed_at >= REST_SECONDS:
            self._act(self._end(session.id))

    async def close(self) -> None:
        """Wait for a start or stop in progress."""
        if self._task is not None:
            await self._task

    @property
    def _acts(self) -> bool:
        """True while a session is being started or stopped."""
        return self._task is not None and not self._task.done()

    def _act(self, step: "asyncio._CoroutineLike[None]") -> None:
        if self._acts:
            step.close()
        else:
            self._task = asyncio.create_task(step)

    async def _begin(self, state: str) -> None:
        try:
            await self._recorder.start(
                await self._make_row(default_name(datetime.now(UTC), armed=True), state)
            )
            self._write_arming()
        except RecordingRefusedError as problem:
            log.info("arming starts no session: %s", problem)
        except (StoreError, OSError) as problem:
            self._notices.notify("recording", "caution", f"Armed, but not recorded: {problem}.")

    def _write_arming(self) -> None:
        if self._armed_by:
            self._notices.notify("control", "info", self._armed_by)
        self._armed_by = ""

    async def _end(self, session: int) -> None:
        try:
            await self._recorder.stop(session)
        except (RecordingRefusedError, StoreError) as problem:
            log.info("the session started at arming cannot be stopped yet: %s", problem)
