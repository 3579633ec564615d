"""A runtime that is a service of its own: it outlives servers, waits for its board, and feeds systemd."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from robot_runtime.errors import RefusedError
from robot_runtime.service_manager import ServiceManager
from server import cli
from server.platform.folder_lock import claim
from server.platform.pidfile import end_parts, pid_file, running_parts
from server.platform.settings import DataFolder, Settings, SetupError, make_folders
from server.processes import external_process, runtime_service
from server.processes.external_process import ABSENT
from server.processes.managed_process import ProcessCommand
from tests.server.processes.test_parts import Crew, running
from tests.server.waiting import SECONDS, alive, until
from tests.stack import ROOT
from tests.waiting import wait_for

CONFIG = '[robot]\nname = "tested"\nmode = "robot"\n[link]\nport = "/nowhere"\n'
WAITS = b"READY=1\nWATCHDOG_USEC=60000000\nWATCHDOG=1"


def runtime_of(folder: DataFolder) -> int | None:
    result = running_parts(folder.run).get("runtime")
    return None if result is None else result.pid


@contextmanager
def service(settings: Settings, notify: Path | None = None) -> Iterator[subprocess.Popen[str]]:
    """`mucat runtime` as systemd starts it."""
    settings.config.write_text(CONFIG)
    command = [sys.executable, "-m", "server.cli", "runtime"]
    command += ["--config", str(settings.config), "--data", str(settings.data.path)]
    manager = {"NOTIFY_SOCKET": str(notify), "WATCHDOG_USEC": "5000000"}
    environment = os.environ | (manager if notify else {})
    with subprocess.Popen(
        command,
        cwd=ROOT,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.wait(SECONDS)


def external(name: str = "engine") -> ProcessCommand:
    return ProcessCommand(name, f"part {name}", (), external=True)


@contextmanager
def engine(crew_folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A process that somebody else starts, and that enters itself."""
    with subprocess.Popen(
        [sys.executable, "-c", "import time; time.sleep(600)"], start_new_session=True
    ) as visitor:
        pid_file(crew_folder / "run", "engine").write(visitor.pid, "made")
        try:
            yield visitor
        finally:
            visitor.kill()


async def test_a_server_watches_it_and_leaves_it_running(tmp_path: Path) -> None:
    crew = Crew(tmp_path, external())

    with engine(tmp_path) as first:
        async with running(crew):
            await until(lambda: crew.part("engine").state == "running", "running")
            assert crew.part("engine").pid == first.pid
        assert first.poll() is None
        assert crew.changes == []


async def test_its_death_is_reported_and_the_next_one_watched(tmp_path: Path) -> None:
    crew = Crew(tmp_path, external())

    async with running(crew):
        with engine(tmp_path) as first:
            await until(lambda: crew.part("engine").state == "running", "running")
            first.kill()
            first.wait()
            await until(lambda: crew.part("engine").state == "failed", "failed")
        with engine(tmp_path) as second:
            await until(lambda: crew.part("engine").state == "running", "running")
            assert crew.part("engine").pid == second.pid
        assert [name for name, _ in crew.changes][:1] == ["engine"]
        assert crew.changes[0][1] == (
            "The part engine has ended; journalctl -u mucat-runtime says why. systemd starts it again."
        )


async def test_one_that_does_not_come_back_is_reported_with_how_to_start_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(external_process, "ABSENT_SECONDS", 0.0)
    crew = Crew(tmp_path, external())

    with engine(tmp_path) as first:
        async with running(crew):
            await until(lambda: crew.part("engine").state == "running", "running")
            first.kill()
            first.wait()
            await until(lambda: crew.part("engine").problem == ABSENT, "it to be missed")
            with engine(tmp_path):
                await until(lambda: crew.part("engine").state == "running", "running")
                assert [text for _, text in crew.changes][1:] == [f"The part engine {ABSENT}."]


@pytest.mark.parametrize("moment", ["before", "after"])
def test_a_pause_while_it_enters_itself_is_obeyed(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    """The program that pauses it finds no process yet, or one that must end."""
    folder, turns = settings.data, []
    results: list[bool] = []

    def wait(*_: object) -> None:
        turns.append(runtime_of(folder))
        if len(turns) > 1:
            raise SetupError("it waits again")

    @contextmanager
    def hold(_: Path) -> Iterator[None]:
        if moment == "before":
            folder.runtime_paused.touch()
            results.append("runtime" in running_parts(folder.run))
        yield
        if moment == "after":
            folder.runtime_paused.touch()
            results.append("runtime" in running_parts(folder.run))

    monkeypatch.setattr(runtime_service, "_wait_for_turn", wait)
    monkeypatch.setattr(runtime_service, "hold_still", hold)
    monkeypatch.setattr(os, "execv", lambda *_: None)
    settings.config.write_text(CONFIG)
    options = ["--config", str(settings.config), "--data", str(folder.path)]
    with claim(folder):
        assert cli.main(["runtime", *options]) == 1
    assert results == [moment == "after"]
    assert turns == [None, None]


async def test_a_pause_ends_it_and_marks_the_folder_until_it_is_resumed(tmp_path: Path) -> None:
    crew = Crew(tmp_path, external())
    marker = DataFolder(tmp_path).runtime_paused

    with engine(tmp_path) as database:
        async with running(crew):
            await until(lambda: crew.part("engine").state == "running", "running")
            await crew.parts.pause("engine", "The board is used.")
            assert crew.part("engine").state == "paused"
            assert marker.exists()
            crew.parts.resume("engine")
            await until(lambda: crew.part("engine").state == "waiting", "waiting")
            assert not marker.exists()
        assert database.wait(SECONDS) == -signal.SIGTERM


async def test_where_it_cannot_be_paused_it_is_still_watched(tmp_path: Path) -> None:
    """As on a card that has become read-only; here a folder lies where the file belongs."""
    crew = Crew(tmp_path, external())

    with engine(tmp_path) as database:
        async with running(crew):
            await until(lambda: crew.part("engine").state == "running", "running")
            DataFolder(tmp_path).runtime_paused.mkdir()
            with pytest.raises(RefusedError, match="cannot be written"):
                await crew.parts.pause("engine", "The board is used.")
            await until(lambda: crew.part("engine").state == "running", "running again")
            database.kill()
            database.wait()
            await until(lambda: crew.part("engine").state == "failed", "failed")
    assert [name for name, _ in crew.changes] == ["engine"]


def test_it_enters_itself_and_its_number_stays(settings: Settings) -> None:
    with service(settings) as process:
        wait_for(lambda: runtime_of(settings.data) == process.pid)
        wait_for(settings.data.runtime_socket.exists)
        # An emptied folder would cut it off from the server.
        make_folders(settings.data)
        assert settings.data.runtime_socket.exists()


def test_there_is_one_at_a_time(settings: Settings) -> None:
    with service(settings) as first:
        wait_for(lambda: runtime_of(settings.data) == first.pid)
        with service(settings) as second:
            assert second.wait(SECONDS) == 1
            assert second.stderr is not None
            assert "A runtime works on" in second.stderr.read()
        assert alive(first.pid)


def test_it_waits_while_another_program_uses_its_board(settings: Settings) -> None:
    folder = settings.data
    with service(settings) as first:
        wait_for(lambda: runtime_of(folder) == first.pid)
        with claim(folder):
            end_parts(folder.run)
            first.wait(SECONDS)
            path = folder.path.parent / "notify"
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
                manager.bind(str(path))
                manager.settimeout(SECONDS)
                with service(settings, path) as second:
                    assert [manager.recv(100) for _ in range(3)] == [WAITS] * 3
                    assert runtime_of(folder) is None
                    folder.runtime_paused.unlink()
                    wait_for(lambda: runtime_of(folder) == second.pid)


def test_a_mark_that_a_killed_program_has_left_does_not_hold_it(settings: Settings) -> None:
    settings.data.runtime_paused.touch()
    with service(settings) as process:
        wait_for(lambda: runtime_of(settings.data) == process.pid)


def test_it_feeds_systemd_from_the_control_loop(settings: Settings) -> None:
    path = settings.data.path.parent / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(path))
        manager.settimeout(SECONDS)
        with service(settings, path):
            assert manager.recv(100) == b"READY=1\nWATCHDOG_USEC=5000000"
            assert [manager.recv(100) for _ in range(2)] == [b"WATCHDOG=1"] * 2


def test_systemd_is_fed_once_a_second_and_without_it_nothing_happens(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = settings.data.path.parent / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(path))
        manager.setblocking(False)
        monkeypatch.setenv("NOTIFY_SOCKET", str(path))
        item = ServiceManager()
        for tick in range(21):
            item.feed(tick / 10)
        assert [manager.recv(100) for _ in range(3)] == [b"WATCHDOG=1"] * 3
        item.wait(1.5)
        assert manager.recv(100) == b"READY=1"
        with pytest.raises(BlockingIOError):
            manager.recv(100)
    item.ready()  # to nobody
    monkeypatch.delenv("NOTIFY_SOCKET")
    ServiceManager().ready()
