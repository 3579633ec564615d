"""Automatic recording while the robot is armed."""

import asyncio
import json
import threading
from typing import Any

import pytest

import server.recording.recorder as recorder_module
from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.auto_recording import REST_SECONDS, AutoRecorder
from server.recording.recorder import Recorder
from server.recording.session import new_row
from tests.server.blocks import state_block
from tests.server.waiting import SECONDS, until


class _Rig:
    """A recorder with the automatic recording on the robot's state."""

    def __init__(self, store: Store, settings: Settings) -> None:
        self.clock = SimulatedClock(50.0)
        self.settings = settings
        self.notices: list[tuple[str, str | None]] = []
        notices = Notices(self.clock, self.note)
        self.recorder = Recorder(store, self.clock, notices, lambda: None)
        self.arming = AutoRecorder(self.recorder, self.clock, notices, self.make_row)

    async def make_row(self, name: str, state: str) -> SessionRow:
        return new_row(self.settings, self.clock, name, "", state, origin="arming")

    def note(self, block: Block) -> None:
        """Remember a notice about control, and what is recorded at its time."""
        (event,) = json.loads(block.payload)
        if event["kind"] == "control":
            self.notices.append((event["text"], self.recording))

    async def see(self, *states: bool) -> None:
        """Show states that arrive together, each armed or not, and wait for what follows."""
        self.show(*states)
        await self.arming.close()

    def show(self, *states: bool) -> None:
        """Show these states."""
        self.arming.see([state_block(0, armed=armed) for armed in states])

    async def wait(self, seconds: float) -> None:
        self.clock.forward(seconds)
        self.arming.tick()
        await self.arming.close()

    @property
    def recording(self) -> str | None:
        session = self.recorder.session
        return None if session is None else session.origin


@pytest.fixture
def rig(store: Store, settings: Settings) -> _Rig:
    return _Rig(store, settings)


async def test_it_records_while_armed_and_until_the_fins_rest(rig: _Rig) -> None:
    await rig.see(False)
    await rig.wait(60)
    assert rig.recording is None
    await rig.see(True)
    assert rig.recording == "arming"
    await rig.wait(60)
    await rig.see(False)
    await rig.wait(REST_SECONDS - 1)
    await rig.see(True)
    await rig.wait(60)
    assert rig.recording == "arming"
    await rig.see(False)
    await rig.see(False)
    await rig.wait(REST_SECONDS - 0.1)
    assert rig.recording == "arming"
    await rig.wait(0.1)
    assert rig.recording is None


async def test_the_session_that_arming_starts_says_who_armed(rig: _Rig) -> None:
    await rig.see(False)
    rig.arming.note_arming("“Anna” armed the robot.")
    await rig.see(True)
    assert rig.notices == [("“Anna” armed the robot.", "arming")]
    rig.arming.note_arming("“Eve” armed the robot.")
    assert rig.notices[1:] == [("“Eve” armed the robot.", "arming")]


async def test_who_armed_is_not_told_of_a_later_arming(rig: _Rig) -> None:
    rig.arming.note_arming("“Anna” armed the robot.")
    await rig.wait(2)
    assert rig.notices == [("“Anna” armed the robot.", None)]
    await rig.see(True)
    assert len(rig.notices) == 1


async def test_automatic_recording_does_not_end_an_operator_s_session(settings: Settings, rig: _Rig) -> None:
    row = new_row(settings, rig.clock, "mine", "", "null")
    await rig.recorder.start(row)
    await rig.see(True)
    await rig.see(False)
    await rig.wait(2 * REST_SECONDS)
    assert rig.recording == "operator"


async def test_a_recording_of_an_earlier_server_is_ended_too(rig: _Rig) -> None:
    await rig.recorder.start(await rig.make_row("resumed", "null"))
    await rig.see(False)
    await rig.wait(REST_SECONDS)
    assert rig.recording is None


async def test_an_operator_can_stop_it(rig: _Rig) -> None:
    await rig.see(True)
    assert rig.recorder.session is not None
    await rig.recorder.stop(rig.recorder.session.id)
    await rig.see(True)
    await rig.wait(1)
    assert rig.recording is None


async def test_a_backlog_starts_no_session_for_what_is_over(rig: _Rig) -> None:
    await rig.see(False, True, True, False)
    assert rig.recording is None
    await rig.see(True, False, True)
    assert rig.recording == "arming"


def hold_commits(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """Make the recorder's commits wait for the event that is returned."""
    release, insert = threading.Event(), recorder_module._insert

    def wait(*arguments: Any) -> None:
        assert release.wait(SECONDS)
        insert(*arguments)

    monkeypatch.setattr(recorder_module, "_insert", wait)
    return release


async def test_arming_while_a_session_s_end_is_stored_starts_another(
    monkeypatch: pytest.MonkeyPatch, rig: _Rig
) -> None:
    await rig.see(True)
    first = rig.recorder.session
    await rig.see(False)
    rig.clock.forward(REST_SECONDS)
    release = hold_commits(monkeypatch)
    rig.arming.tick()
    await until(lambda: rig.recorder.stopping, "the end of the session to begin")
    rig.show(True)
    release.set()
    await rig.arming.close()
    assert rig.recording is None
    await rig.see(True)
    assert first is not None
    assert rig.recorder.session is not None
    assert rig.recorder.session.id != first.id


async def test_arming_while_an_operator_stops_a_session_starts_another(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, rig: _Rig
) -> None:
    session = await rig.recorder.start(new_row(settings, rig.clock, "mine", "", "null"))
    release = hold_commits(monkeypatch)
    stop = asyncio.create_task(rig.recorder.stop(session.id))
    await until(lambda: rig.recorder.stopping, "the end of the session to begin")
    rig.show(True)
    release.set()
    await stop
    await rig.see(True)
    assert rig.recording == "arming"
