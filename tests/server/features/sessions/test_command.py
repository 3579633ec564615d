"""Sessions from a shell, beside a running server and without one."""

import asyncio

import pytest

from robot_runtime.clock import SimulatedClock
from server.cli import main
from server.platform.folder_lock import claim
from server.platform.notices import Notices
from server.platform.running_server import announce
from server.platform.schema import prepare
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import new_row
from tests.server.serving import serve


def run(settings: Settings, *arguments: str) -> int:
    common = ("--data", str(settings.data.path), "--config", str(settings.config))
    return main([*arguments, *common])


def test_a_data_folder_that_cannot_be_used_is_no_running_server(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    settings.data.lock.mkdir()
    assert run(settings, "sessions", "delete", "1") == 1
    assert "cannot be used: Is a directory" in capsys.readouterr().err


def test_sessions_without_a_server(settings: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    prepare(settings.data)
    store = Store(settings.data.database)
    clock = SimulatedClock(50.0)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)

    async def record() -> None:
        session = await recorder.start(new_row(settings, clock, "dive", "", "null"))
        await recorder.stop(session.id)

    asyncio.run(record())
    store.close()

    def output_of(*arguments: str) -> str:
        status = run(settings, *arguments)
        spoken = capsys.readouterr()
        return spoken.out if status == 0 else spoken.err

    assert "changed" in output_of("sessions", "tag", "1", "pool", "sea")
    assert "changed" in output_of("sessions", "tag", "1", "--remove", "sea")
    assert "changed" in output_of("sessions", "note", "1", "calm water")
    assert "dive  [pool]" in output_of("sessions", "list", "calm")
    assert " UTC  " in output_of("sessions", "list", "calm")
    assert "No matching session" in output_of("sessions", "list", "--tag", "sea")
    assert "tags: pool" in output_of("sessions", "show", "1")
    assert "bin" in output_of("sessions", "delete", "1")
    assert "dive" in output_of("sessions", "list", "--deleted")
    assert "back" in output_of("sessions", "restore", "1")
    assert "There is no session 7" in output_of("sessions", "delete", "7")
    assert output_of("sessions", "tag", "1", "a,b").startswith("mucat: ")
    assert "No server works on" in output_of("record", "start")


def test_the_command_works_in_a_new_folder(settings: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    settings.data.database.unlink(missing_ok=True)
    assert run(settings, "sessions", "list") == 0
    assert "No matching session" in capsys.readouterr().out


async def test_requests_to_a_running_server(settings: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    with claim(settings.data):
        async with serve(settings) as served:
            announce(served.settings)
            for arguments in (
                ("record", "start", "from the shell"),
                ("sessions", "tag", "1", "pool"),
                ("sessions", "delete", "1"),
                ("record", "stop"),
                ("sessions", "delete", "1"),
            ):
                await asyncio.to_thread(run, settings, *arguments)
            (session,) = (await served.api.get("/sessions", params={"deleted": True})).json()
            assert (session["name"], session["tags"]) == ("from the shell", ["pool"])
    spoken = capsys.readouterr()
    assert "it is session 1" in spoken.out
    assert "Stop it first" in spoken.err
