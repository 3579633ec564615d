"""Marks of missions become bookmarks of the session that records: once each, at their own moment."""

import json

from robot_runtime.contract.documents import MISSION_MARK
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from server.features.missions.marks import MissionMarks
from server.library.bookmarks import Bookmarks
from server.library.catalogue import Catalogue
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.recording.recorder_rig import RecorderRig


def _block(*marks: tuple[float, str]) -> Block:
    events = [{"time": time, "kind": MISSION_MARK, "severity": "info", "text": text} for time, text in marks]
    return Block.of(BY_NAME["event"], len(events), 0, json.dumps(events).encode())


class _MarksRig(RecorderRig):
    """A recorder with the marks of missions."""

    def __init__(self, store: Store, settings: Settings) -> None:
        super().__init__(store, settings)
        self.catalogue = Catalogue(store, self.recorder)
        self.marks = MissionMarks(self.recorder, Bookmarks(store, self.clock, self.recorder), self.catalogue)

    async def see(self, *marks: tuple[float, str]) -> None:
        """Take a block of these marks, and wait until they are stored."""
        self.marks.see(_block(*marks))
        await self.marks.close()

    def stored(self, session: int) -> list[tuple[float, str]]:
        """Times, s since the session's start, and texts."""
        return [(mark.time, mark.text) for mark in self.catalogue.detail(session).marks]


async def test_a_mark_is_a_bookmark_at_its_own_moment_and_the_pages_are_told(
    store: Store, settings: Settings
) -> None:
    rig = _MarksRig(store, settings)

    session = await rig.start()
    rig.clock.forward(20.0)
    await rig.see((57.0, "here"), (62.5, "there"))
    assert rig.stored(session) == [(7.0, "here"), (12.5, "there")]
    assert rig.recorder.session is not None
    assert rig.recorder.session.markers == 2
    await rig.recorder.stop(session)


async def test_a_backlog_repeats_no_mark_and_adds_those_that_were_missed(
    store: Store, settings: Settings
) -> None:
    rig = _MarksRig(store, settings)

    session = await rig.start()
    rig.clock.forward(20.0)
    await rig.see((57.0, "here"))
    rig.clock.forward(60.0)
    await rig.see((49.0, "before the session"), (57.0, "here"), (80.0, "here"))
    assert rig.stored(session) == [(7.0, "here"), (30.0, "here")]
    await rig.recorder.stop(session)
