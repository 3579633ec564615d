import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil
import pytest

from server.platform.folder_lock import runner_of
from server.platform.settings import DataFolder
from tests.server.waiting import SECONDS, alive
from tests.waiting import wait_for

ROOT = Path(__file__).resolve().parents[3]
NAMES = ("mucat-runner", "mucat-server")


def kill(process: psutil.Process) -> None:
    """Send SIGKILL, and wait for the end: on a busy computer a killed process stays for a moment."""
    process.kill()
    wait_for(lambda: not alive(process.pid), "the end of what was killed")


class Family:
    """A runner and the server that it has forked, in a process group of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        command = [sys.executable, "-m", "tests.server.processes.small_servers", str(folder)]
        self.errors = (folder / "words").open("wb")
        self.started = subprocess.Popen(command, cwd=ROOT, stderr=self.errors, start_new_session=True)

    @property
    def servers(self) -> list[tuple[int, str]]:
        """Process numbers of the servers so far, each with the end of the server before it."""
        log = self.folder / "servers"
        lines = log.read_text().splitlines() if log.exists() else []
        return [(int(pid), ended) for pid, _, ended in (line.partition(" ") for line in lines)]

    def find(self, name: str) -> list[psutil.Process]:
        results = []
        for pid in psutil.pids():
            # The group is asked first: it costs a hundredth of a process's name.
            with suppress(psutil.Error, ProcessLookupError):
                if os.getpgid(pid) == self.started.pid and (process := psutil.Process(pid)).name() == name:
                    results.append(process)
        return [process for process in results if alive(process.pid)]

    def whole(self) -> bool:
        """Check that there is one runner and one server, and that it serves."""
        everybody = [self.find(name) for name in NAMES]
        if [len(group) for group in everybody] != [1, 1]:
            return False
        return bool(self.servers) and self.servers[-1][0] == everybody[1][0].pid

    def kill(self, name: str) -> int:
        (process,) = self.find(name)
        kill(process)
        return process.pid

    def gone(self) -> bool:
        return not any(self.find(name) for name in NAMES)


@contextmanager
def ending(family: Family) -> Iterator[Family]:
    try:
        yield family
    finally:
        with suppress(ProcessLookupError):
            os.killpg(family.started.pid, signal.SIGKILL)
        family.started.wait()
        family.errors.close()


@contextmanager
def running(folder: Path) -> Iterator[Family]:
    with ending(Family(folder)) as family:
        wait_for(family.whole, "the server")
        yield family


def test_a_killed_server_is_replaced_and_the_next_one_gets_the_reason(tmp_path: Path) -> None:
    with running(tmp_path) as family:
        first = family.kill("mucat-server")
        wait_for(lambda: family.whole() and len(family.servers) == 2, "the next server")
        assert family.servers[0] == (first, "")
        assert family.servers[1][1] == "The server was ended by signal SIGKILL."
        family.kill("mucat-server")
        wait_for(lambda: family.whole() and len(family.servers) == 3, "the third server")
    assert "It is started again at once." in (tmp_path / "words").read_text()
    assert "It is started again in 0.1 s." in (tmp_path / "words").read_text()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("everybody", [True, False])
def test_it_ends_in_order_on_sigterm(tmp_path: Path, number: signal.Signals, everybody: bool) -> None:
    with running(tmp_path) as family:
        # Ctrl-C reaches all of them.
        (os.killpg if everybody else os.kill)(family.started.pid, number)
        assert family.started.wait(SECONDS) == 0
        assert (tmp_path / "bye").exists()
        assert family.gone()
        assert runner_of(DataFolder(tmp_path)) is None


def test_it_runs_servers_also_where_it_cannot_enter_itself(tmp_path: Path) -> None:
    file = DataFolder(tmp_path).runner
    file.with_name(file.name + ".new").mkdir()
    with running(tmp_path) as family:
        assert runner_of(DataFolder(tmp_path)) is None
        os.kill(family.started.pid, signal.SIGTERM)
        assert family.started.wait(SECONDS) == 0


def test_a_server_that_ends_in_order_by_itself_ends_the_runner(tmp_path: Path) -> None:
    with running(tmp_path) as family:
        os.kill(family.servers[0][0], signal.SIGTERM)
        assert family.started.wait(SECONDS) == 0
        assert family.gone()


def test_a_first_server_that_cannot_start_is_not_tried_again(tmp_path: Path) -> None:
    (tmp_path / "broken").touch()
    with ending(Family(tmp_path)) as family:
        assert family.started.wait(SECONDS) == 1
        assert (tmp_path / "broken").read_text() == "x"
        assert family.gone()
    output = (tmp_path / "words").read_text()
    assert "The server has ended with exit status 1 before it could serve" in output


@pytest.mark.parametrize(
    ("how", "described"),
    [
        ("1", "has ended with exit status 1"),
        ("0", "has ended with exit status 0"),
        ("abort", "signal SIGABRT"),
    ],
)
def test_a_server_that_has_served_is_started_again_however_it_ended(
    tmp_path: Path, how: str, described: str
) -> None:
    (tmp_path / "exit").write_text(how)
    with ending(Family(tmp_path)) as family:
        wait_for(lambda: family.started.poll() is not None or len(family.servers) == 2, "the next server")
        assert family.started.poll() is None
        wait_for(family.whole, "the next server")
        ended = family.servers[1][1]
        assert described in ended
        assert ended.endswith("Its last words: Memory allocation still failed, giving up.")
        os.kill(family.started.pid, signal.SIGTERM)
        assert family.started.wait(SECONDS) == 0
    assert f"{ended} It is started again at once." in (tmp_path / "words").read_text()


def test_a_later_one_that_cannot_start_is_tried_until_it_can(tmp_path: Path) -> None:
    with running(tmp_path) as family:
        (tmp_path / "broken").touch()
        family.kill("mucat-server")
        wait_for(lambda: len((tmp_path / "broken").read_text()) >= 3, "three tries")
        (tmp_path / "broken").unlink()
        wait_for(family.whole, "a server")
        assert len(family.servers) == 2


def test_a_killed_runner_takes_its_server_with_it(tmp_path: Path) -> None:
    with running(tmp_path) as family:
        assert runner_of(DataFolder(tmp_path)) == family.started.pid
        # With -9 the process is gone for its parent, this one, only when it was waited for.
        family.started.kill()
        assert family.started.wait(SECONDS) == -signal.SIGKILL
        wait_for(family.gone, "the end of the server")
        assert runner_of(DataFolder(tmp_path)) is None
        # Killed, not ended in order: the robot is left as it is, for the next start to adopt.
        assert not (tmp_path / "bye").exists()


def test_a_server_killed_twenty_times_at_any_moment_is_there_again(tmp_path: Path) -> None:
    chance = random.Random(5)
    with running(tmp_path) as family:
        for _ in range(20):
            family.kill("mucat-server")
            # The next one may just start when it is hit, too.
            time.sleep(chance.uniform(0, 0.03))
            for server in family.find("mucat-server"):
                kill(server)
            wait_for(family.whole, "the next server")
