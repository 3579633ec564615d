import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil
import pytest

from server.platform.settings import DataFolder
from server.processes.keeper import keeper_of, relieve
from tests.server.waiting import SECONDS, alive

pytestmark = pytest.mark.stack

ROOT = Path(__file__).resolve().parents[3]
NAMES = ("mucat-keeper", "mucat-second", "mucat-server")


def wait(condition: Callable[[], object], what: str) -> None:
    end = time.monotonic() + SECONDS
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.005)


def kill(process: psutil.Process) -> None:
    """With -9, and see it end: on a busy computer a process that was killed is there for a moment yet."""
    process.kill()
    wait(lambda: not alive(process.pid), "the end of what was killed")


class Family:
    """A keeper with what it has forked: a group of processes of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        command = [sys.executable, "-m", "tests.server.processes.kept", str(folder)]
        self.words = (folder / "words").open("wb")
        self.started = subprocess.Popen(command, cwd=ROOT, stderr=self.words, start_new_session=True)

    @property
    def servers(self) -> list[tuple[int, str]]:
        """Those that have served: their processes, and what they were told of the one before."""
        log = self.folder / "servers"
        lines = log.read_text().splitlines() if log.exists() else []
        return [(int(pid), ended) for pid, _, ended in (line.partition(" ") for line in lines)]

    def find(self, name: str) -> list[psutil.Process]:
        found = []
        for process in psutil.process_iter():
            with suppress(psutil.Error, ProcessLookupError):
                if process.name() == name and os.getpgid(process.pid) == self.started.pid:
                    found.append(process)
        return [process for process in found if alive(process.pid)]

    def whole(self) -> bool:
        """One of each, and the server serves."""
        everybody = [self.find(name) for name in NAMES]
        if [len(one) for one in everybody] != [1, 1, 1]:
            return False
        return bool(self.servers) and self.servers[-1][0] == everybody[2][0].pid

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
        family.words.close()


@contextmanager
def keeping(folder: Path) -> Iterator[Family]:
    with ending(Family(folder)) as family:
        wait(family.whole, "the server")
        yield family


def test_a_server_that_is_killed_is_replaced_and_the_next_one_is_told(tmp_path: Path) -> None:
    with keeping(tmp_path) as family:
        first = family.kill("mucat-server")
        wait(lambda: family.whole() and len(family.servers) == 2, "the next server")
        assert family.servers[0] == (first, "")
        assert family.servers[1][1] == "The server was ended by signal SIGKILL."
        family.kill("mucat-server")
        wait(lambda: family.whole() and len(family.servers) == 3, "the third server")
    assert "It is started again at once." in (tmp_path / "words").read_text()
    assert "It is started again in 0.1 s." in (tmp_path / "words").read_text()


def test_a_keeper_that_is_killed_is_replaced_and_the_server_serves_on(tmp_path: Path) -> None:
    with keeping(tmp_path) as family:
        assert keeper_of(DataFolder(tmp_path)) == family.started.pid
        for _ in range(2):
            (server, _), *_ = family.servers
            family.kill("mucat-keeper")
            wait(family.whole, "the next keeper")
            assert [pid for pid, _ in family.servers] == [server]
        family.kill("mucat-server")
        wait(lambda: family.whole() and len(family.servers) == 2, "the next server")
        keeper = keeper_of(DataFolder(tmp_path))
        assert keeper is not None
        assert keeper != family.started.pid
        os.kill(keeper, signal.SIGTERM)
        wait(family.gone, "the end")
        assert (tmp_path / "bye").exists()


def test_a_second_that_is_killed_is_replaced(tmp_path: Path) -> None:
    with keeping(tmp_path) as family:
        second = family.kill("mucat-second")
        wait(lambda: family.whole() and family.find("mucat-second")[0].pid != second, "the next second")
        assert len(family.servers) == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("everybody", [True, False])
def test_it_ends_in_order_when_told(tmp_path: Path, number: signal.Signals, everybody: bool) -> None:
    with keeping(tmp_path) as family:
        # Ctrl-C reaches all of them.
        (os.killpg if everybody else os.kill)(family.started.pid, number)
        assert family.started.wait(SECONDS) == 0
        assert (tmp_path / "bye").exists()
        assert family.gone()
        assert keeper_of(DataFolder(tmp_path)) is None


def test_a_server_that_ends_in_order_by_itself_ends_the_keeper(tmp_path: Path) -> None:
    with keeping(tmp_path) as family:
        os.kill(family.servers[0][0], signal.SIGTERM)
        assert family.started.wait(SECONDS) == 0
        assert family.gone()


def test_a_first_server_that_cannot_start_is_not_tried_again(tmp_path: Path) -> None:
    (tmp_path / "broken").touch()
    with ending(Family(tmp_path)) as family:
        assert family.started.wait(SECONDS) == 1
        assert (tmp_path / "broken").read_text() == "x"
        assert family.gone()


def test_a_later_one_that_cannot_start_is_tried_until_it_can(tmp_path: Path) -> None:
    with keeping(tmp_path) as family:
        (tmp_path / "broken").touch()
        family.kill("mucat-server")
        wait(lambda: (tmp_path / "broken").read_text() == "xxx", "three tries")
        (tmp_path / "broken").unlink()
        wait(family.whole, "a server")
        assert len(family.servers) == 2


def test_what_a_killed_keeper_has_left_gives_way_to_the_next_start(tmp_path: Path) -> None:
    with keeping(tmp_path) as family:
        relieve(DataFolder(tmp_path))
        assert family.whole()
        family.kill("mucat-keeper")
        wait(family.whole, "the next keeper")
        relieve(DataFolder(tmp_path))
        wait(family.gone, "the end")
        # Not in order: the robot is left as it is.
        assert not (tmp_path / "bye").exists()


def test_whoever_is_killed_whenever_there_is_one_of_each_again(tmp_path: Path) -> None:
    chance = random.Random(5)
    with keeping(tmp_path) as family:
        for _ in range(20):
            family.kill(chance.choice(NAMES))
            # The others are about to notice, and then it hits the server, too.
            time.sleep(chance.uniform(0, 0.03))
            for server in family.find("mucat-server"):
                kill(server)
            wait(family.whole, "all three")
