"""Automatic recording while the robot is armed."""

import asyncio
import json
from collections.abc import Awaitable, Callable

from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.features.sessions.auto_recording import REST_SECONDS, AutoRecorder
from server.features.sessions.recorder import Recorder
from server.features.sessions.session import new_row
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.blocks import state_block


class _ProcessGroup:
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

    async def see(self, armed: bool) -> None:
        self.arming.see(state_block(0, armed=armed))
        await self.arming.close()

    async def wait(self, seconds: float) -> None:
        self.clock.forward(seconds)
        self.arming.tick()
        await self.arming.close()

    @property
    def recording(self) -> str | None:
        session = self.recorder.session
        return None if session is None else session.origin


def play(store: Store, settings: Settings, scenario: Callable[[_ProcessGroup], Awaitable[None]]) -> None:
    async def run() -> None:
        await scenario(_ProcessGroup(store, settings))

    asyncio.run(run())


def test_it_records_while_armed_and_until_the_fins_rest(store: Store, settings: Settings) -> None:
    async def scenario(watched: _ProcessGroup) -> None:
        await watched.see(armed=False)
        await watched.wait(60)
        assert watched.recording is None
        await watched.see(armed=True)
        assert watched.recording == "arming"
        await watched.wait(60)
        await watched.see(armed=False)
        await watched.wait(REST_SECONDS - 1)
        await watched.see(armed=True)
        await watched.wait(60)
        assert watched.recording == "arming"
        await watched.see(armed=False)
        await watched.see(armed=False)
        await watched.wait(REST_SECONDS - 0.1)
        assert watched.recording == "arming"
        await watched.wait(0.1)
        assert watched.recording is None

    play(store, settings, scenario)


def test_the_session_that_arming_starts_says_who_armed(store: Store, settings: Settings) -> None:
    async def scenario(watched: _ProcessGroup) -> None:
        await watched.see(armed=False)
        watched.arming.note_arming("“Anna” armed the robot.")
        await watched.see(armed=True)
        assert watched.notices == [("“Anna” armed the robot.", "arming")]
        watched.arming.note_arming("“Eve” armed the robot.")
        assert watched.notices[1:] == [("“Eve” armed the robot.", "arming")]

    play(store, settings, scenario)


def test_who_armed_is_not_told_of_a_later_arming(store: Store, settings: Settings) -> None:
    async def scenario(watched: _ProcessGroup) -> None:
        watched.arming.note_arming("“Anna” armed the robot.")
        await watched.wait(2)
        assert watched.notices == [("“Anna” armed the robot.", None)]
        await watched.see(armed=True)
        assert len(watched.notices) == 1

    play(store, settings, scenario)


def test_automatic_recording_does_not_end_an_operator_s_session(store: Store, settings: Settings) -> None:
    async def scenario(watched: _ProcessGroup) -> None:
        row = new_row(settings, watched.clock, "mine", "", "null")
        await watched.recorder.start(row)
        await watched.see(armed=True)
        await watched.see(armed=False)
        await watched.wait(2 * REST_SECONDS)
        assert watched.recording == "operator"

    play(store, settings, scenario)


def test_a_recording_of_an_earlier_server_is_ended_too(store: Store, settings: Settings) -> None:
    async def scenario(watched: _ProcessGroup) -> None:
        await watched.recorder.start(await watched.make_row("resumed", "null"))
        await watched.see(armed=False)
        await watched.wait(REST_SECONDS)
        assert watched.recording is None

    play(store, settings, scenario)


def test_an_operator_can_stop_it(store: Store, settings: Settings) -> None:
    async def scenario(watched: _ProcessGroup) -> None:
        await watched.see(armed=True)
        assert watched.recorder.session is not None
        await watched.recorder.stop(watched.recorder.session.id)
        await watched.see(armed=True)
        await watched.wait(1)
        assert watched.recording is None

    play(store, settings, scenario)
