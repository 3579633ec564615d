"""The marks of missions, put into the recording session."""

import asyncio
import json
import logging

from robot_runtime.contract.documents import MISSION_MARK
from robot_runtime.transport.blocks import Block
from server.library.bookmarks import Bookmarks
from server.library.catalogue import Catalogue
from server.platform.errors import ApiError
from server.recording.recorder import Recorder

log = logging.getLogger(__name__)


class MissionMarks:
    """Bookmarks made of the runtime's events of the kind `MISSION_MARK`.

    A server that has been restarted gets those of the last minutes again.
    """

    def __init__(self, recorder: Recorder, bookmarks: Bookmarks, catalogue: Catalogue) -> None:
        self._recorder = recorder
        self._bookmarks = bookmarks
        self._catalogue = catalogue
        self._tasks: set[asyncio.Task[None]] = set()

    def see(self, block: Block) -> None:
        """Take a block of events."""
        session = self._recorder.session
        if session is None or MISSION_MARK.encode() not in block.payload:
            return
        for event in json.loads(block.payload):
            if event.get("kind") == MISSION_MARK:
                task = asyncio.create_task(self._add(session.id, event["time"], str(event["text"])))
                self._tasks.add(task)
                task.add_done_callback(self._tasks.discard)

    async def close(self) -> None:
        """Wait until all marks are stored."""
        await asyncio.gather(*self._tasks)

    async def _add(self, session: int, moment: float, text: str) -> None:
        try:
            if await self._bookmarks.add_once(session, moment, text):
                self._catalogue.notify(session)
        except ApiError as problem:
            log.warning("the mark %r of a mission is not stored: %s", text, problem)
