import fcntl
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import robot_runtime.transport.lifetime as lifetime_module
from robot_runtime.transport.lifetime import is_served, watch_server
from tests.waiting import SECONDS


class CountedClock:
    """A clock that the test sets, with a count of its readings."""

    def __init__(self) -> None:
        self.time = 100.0
        self._looks = 0
        self._looked = threading.Condition()

    def now(self) -> float:
        with self._looked:
            self._looks += 1
            self._looked.notify_all()
            return self.time

    def wait_for_looks(self, count: int) -> None:
        with self._looked:
            expected = self._looks + count
            assert self._looked.wait_for(lambda: self._looks >= expected, SECONDS)


@contextmanager
def serving(lock: Path) -> Iterator[None]:
    with lock.open("w") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lifetime_module, "_CHECK_SECONDS", 0.001)


def test_a_lock_is_tested_without_being_taken(tmp_path: Path) -> None:
    lock = tmp_path / "server.lock"
    assert not is_served(lock)
    with serving(lock):
        assert is_served(lock)
    assert not is_served(lock)
    with serving(lock):
        assert is_served(lock)


def test_a_process_outlives_its_server_for_a_limited_time(tmp_path: Path) -> None:
    lock, clock, ended = tmp_path / "server.lock", CountedClock(), threading.Event()
    with serving(lock):
        watch_server(lock, 30.0, clock, ended.set)
        clock.time += 1000
        clock.wait_for_looks(5)
    clock.time += 29
    clock.wait_for_looks(5)
    with serving(lock):
        clock.wait_for_looks(5)
        clock.time += 1000
        clock.wait_for_looks(5)
    assert not ended.is_set()
    clock.time += 31
    assert ended.wait(SECONDS)


def test_without_the_folder_a_process_ends_at_once(tmp_path: Path) -> None:
    lock, ended = tmp_path / "server.lock", threading.Event()
    lock.touch()
    watch_server(lock, 30.0, CountedClock(), ended.set)
    lock.unlink()
    assert ended.wait(SECONDS)


LIMITED = """
import os
from robot_runtime.transport.lifetime import limit_memory
os.cpu_count = lambda: 1
limit_memory(200_000_000)
try:
    bytearray(300_000_000)
except MemoryError:
    print("refused")
print(len(bytearray(50_000_000)))
limit_memory(600_000_000)
print(len(bytearray(300_000_000)))
"""


def test_memory_beyond_the_limit_is_refused_and_a_process_may_set_another() -> None:
    ran = subprocess.run([sys.executable, "-c", LIMITED], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["refused", "50000000", "300000000"]


GIVE_WAY = """
import os
from robot_runtime.transport.lifetime import give_way
give_way(12)
print(os.getpriority(os.PRIO_PROCESS, 0), open("/proc/self/autogroup").read().split()[-1])
"""


@pytest.mark.parametrize("leads", [True, False])
def test_who_gives_way_does_so_to_other_sessions_where_its_session_is_its_own(leads: bool) -> None:
    if not Path("/proc/self/autogroup").exists():
        pytest.skip("this kernel does not share the processors by session")
    before = Path("/proc/self/autogroup").read_text().split()[-1]
    answer = subprocess.check_output([sys.executable, "-c", GIVE_WAY], start_new_session=leads, text=True)
    niceness = max(12, os.getpriority(os.PRIO_PROCESS, 0))
    assert answer.split() == [str(niceness), "12" if leads else before]
