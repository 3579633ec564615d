"""The wall clock across restarts of the server and of the computer."""

from pathlib import Path

import pytest

from robot_runtime.clock import SimulatedClock
from server.platform import wall_clock
from server.platform.wall_clock import AWAY_SECONDS, DAY, SOFTWARE_MADE, WallClock

NOW = SOFTWARE_MADE + 1e7
HOUR = 3600.0


class RestartedComputer:
    """A computer that is started again and again; `synchronised` is what its kernel says."""

    def __init__(self, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.synchronised = False
        self.starts = 0
        self._path = path
        self._patch = monkeypatch
        monkeypatch.setattr(wall_clock, "is_synchronised", lambda: self.synchronised)
        self.restart()

    def restart(self, *, whole: bool = True) -> None:
        """Start the server again, and with `whole` the computer."""
        if whole:
            self.starts += 1
            boot = str(self.starts)
            self._patch.setattr(wall_clock, "boot", lambda: boot)
            self.clock = SimulatedClock(5.0)
        self._wall = WallClock(self.clock, self._path)

    def knows(self, now: float) -> bool:
        result = self._wall.knows_ages(now)
        self._wall.store()
        return result


@pytest.fixture
def computer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RestartedComputer:
    return RestartedComputer(tmp_path / "wall-clock.json", monkeypatch)


def test_a_start_with_a_date_in_the_future_or_the_past_is_doubted_for_a_day_of_running(
    computer: RestartedComputer,
) -> None:
    assert computer.knows(NOW)
    for wrong in (NOW + 365 * DAY, NOW - HOUR):
        computer.restart()
        assert not computer.knows(wrong)
        # It runs for a few hours at a time.
        for hours in (10, 10):
            computer.clock.forward(hours * HOUR)
            wrong += hours * HOUR
            assert not computer.knows(wrong)
            computer.restart()
            assert not computer.knows(wrong)
        computer.clock.forward(4.1 * HOUR)
        assert computer.knows(wrong + 4.1 * HOUR)
        wrong += 4.1 * HOUR
        computer.restart()
        assert computer.knows(wrong)


def test_a_night_off_and_a_time_server_leave_no_doubt(computer: RestartedComputer) -> None:
    assert computer.knows(NOW)
    computer.restart()
    assert computer.knows(NOW + AWAY_SECONDS - 1)
    computer.restart()
    assert not computer.knows(NOW + 30 * DAY)
    computer.synchronised = True
    computer.clock.forward(60.0)
    assert computer.knows(NOW + 30 * DAY + 60)
    computer.restart()
    assert computer.knows(NOW + 90 * DAY)


def test_a_jump_between_two_servers_is_seen_and_one_server_s_time_is_not(computer: RestartedComputer) -> None:
    assert computer.knows(NOW)
    computer.clock.forward(2 * HOUR)
    computer.restart(whole=False)
    assert computer.knows(NOW + 2 * HOUR)
    computer.restart(whole=False)
    computer.synchronised = True
    assert not computer.knows(NOW + 365 * DAY)


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'{"boot": "1"}', b"null"])
def test_a_damaged_file_is_as_none(computer: RestartedComputer, tmp_path: Path, content: bytes) -> None:
    (tmp_path / "wall-clock.json").write_bytes(content)
    assert computer.knows(NOW)
