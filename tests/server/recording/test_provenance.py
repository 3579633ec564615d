"""A recording holds what was in force as it began, whatever the files are by then."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Event
from robot_runtime.provenance import hash_firmware, hash_software
from robot_runtime.simulation.boards.firmware import firmware_path
from server.platform.models import SessionRow
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.provenance import ProvenanceWatch
from server.recording.recorder import Recorder
from server.recording.session import find_row, new_row
from tests.server.blocks import state_block
from tests.server.serving import Served
from tests.server.waiting import until


class ProvenanceRig:
    """A recorder beside a robot whose files can be changed."""

    def __init__(self, store: Store, settings: Settings, build: Path) -> None:
        self.settings = replace(settings, build=build)
        self.program = firmware_path(build, settings.link.baud, ".hex")
        self.program.parent.mkdir(parents=True)
        self.program.write_bytes(b"first")
        self.notices: list[str] = []
        self._store = store
        clock = SimulatedClock()
        notices = Notices(clock, lambda _: None)
        notices.add_event = self._hear  # type: ignore[method-assign]
        self.watch = ProvenanceWatch(self.settings, self._ask, notices)
        self.recorder = Recorder(store, clock, notices, lambda: None, self.watch)

    async def record(self) -> SessionRow:
        row = new_row(self.settings, SimulatedClock(), "dive", "", "null")
        session = await self.recorder.start(row)
        await self.recorder.stop(session.id)
        return find_row(self._store, session.id)

    def _hear(self, event: Event) -> None:
        if event.kind == "configuration":
            self.notices.append(event.text)

    async def _ask(self) -> Mapping[str, Any]:
        raise AssertionError


@pytest.fixture
def rig(store: Store, settings: Settings, tmp_path: Path) -> ProvenanceRig:
    return ProvenanceRig(store, settings, tmp_path / "build")


async def test_a_file_that_was_edited_or_is_gone_changes_no_recording(rig: ProvenanceRig) -> None:
    await rig.watch.open()
    config, text = rig.settings.config, rig.settings.config_text
    before = await rig.record()
    assert (before.configuration, before.software, rig.notices) == (text, hash_software(), [])
    config.write_bytes("[control]\nset_point = 0.9 # µ\n".encode("latin-1"))
    assert (await rig.record()).configuration == text
    config.unlink()
    assert (await rig.record()).configuration == text
    edited, gone = rig.notices
    assert "robot.toml was edited since the robot has started" in edited
    assert "robot.toml cannot be read now (No such file or directory)" in gone


async def test_firmware_built_anew_is_recorded_once_it_is_on_the_board(rig: ProvenanceRig) -> None:
    await rig.watch.open()
    await rig.watch.see_board(7)
    first = hash_firmware(rig.program)
    rig.program.write_bytes(b"second")
    await rig.watch.see_board(7)
    assert (await rig.record()).firmware == first
    await rig.watch.see_board(8)
    assert (await rig.record()).firmware == hash_firmware(rig.program) != first
    rig.program.write_bytes(b"third")
    await rig.watch.read_firmware()
    assert (await rig.record()).firmware == hash_firmware(rig.program)


async def test_the_runtime_says_what_it_has_read(served: Served) -> None:
    served.runtime.provenance["configuration"] = "# older\n"
    watch = served.get(ProvenanceWatch)
    served.runtime.publish(state_block(0))
    await until(lambda: watch._now.configuration == "# older\n", "the runtime's answer")
    session = (await served.api.post("/sessions", json={})).json()
    detail = (await served.api.get(f"/sessions/{session['id']}")).json()
    assert (detail["configuration"], detail["software"]) == ("# older\n", "0123456789abcdef")
    assert session["software"] == "0123456789abcdef"
