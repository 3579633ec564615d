import shutil
from types import SimpleNamespace
from typing import Any

import pytest

from robot_runtime.contract.documents import Alarm, Event
from robot_runtime.control.alarms import Alarms
from server.health.faults import FAULTS
from server.health.watchdog import DOWN, HUNG_SECONDS, PERIOD, SILENT_SECONDS, STARTING_SECONDS, Watchdog
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.supervisor import ManagedProcess
from tests.server.health.test_health import Bench


class Room(Bench):
    """A bench with the server's alarms."""

    def __init__(self, settings: Settings, store: Store) -> None:
        super().__init__(settings, store, *DOWN)
        self.told: list[Event] = []
        self.alarms = Alarms(self.clock, FAULTS, self.told.append)
        self.watchdog = Watchdog(
            settings,
            self.clock,
            self.monitor,
            self.parts,  # type: ignore[arg-type]
            store,
            self.alarms,
        )

    def spend(self, seconds: float, **said: Any) -> None:
        """Let time pass; `said` is called with each step's number."""
        end = self.clock.now() + seconds
        while self.clock.now() < end:
            self.clock.forward(PERIOD)
            for hear in said.values():
                hear(round(self.clock.now() / PERIOD))
            self.watchdog.check_once()

    def find(self, fault: str) -> Alarm | None:
        return next((alarm for alarm in self.alarms.listed() if alarm.fault == fault), None)

    def active(self) -> set[str]:
        return {alarm.fault for alarm in self.alarms.listed() if alarm.active}


@pytest.fixture
def room(settings: Settings, store: Store) -> Room:
    room = Room(settings, store)
    room.run_all()
    room.spend(1.0, all=room.hear)
    return room


def test_all_is_well(room: Room) -> None:
    room.spend(5.0, all=room.hear)
    assert (room.alarms.listed(), room.told) == ([], [])


def test_whoever_falls_silent_is_an_alarm_until_it_speaks_again(room: Room) -> None:
    last_heard = room.clock.now()
    while "runtime_silent" not in room.active():
        room.spend(PERIOD)
    assert room.clock.now() - last_heard <= SILENT_SECONDS + 2 * PERIOD
    assert room.active() == {"runtime_silent", "simulator_silent"}
    room.spend(PERIOD, all=room.hear)
    assert room.active() == set()
    alarm = room.find("runtime_silent")
    assert alarm is not None
    assert (alarm.active, alarm.acknowledged) == (False, False)
    assert [(event.kind, event.severity) for event in room.told] == [
        ("runtime_silent", "alarm"),
        ("simulator_silent", "caution"),
        ("alarm_over", "info"),
        ("alarm_over", "info"),
    ]
    room.alarms.acknowledge()
    assert room.alarms.listed() == []


def test_what_is_acknowledged_while_it_is_wrong_goes_when_it_is_over(room: Room) -> None:
    room.spend(3.0)
    room.alarms.acknowledge()
    alarm = room.find("runtime_silent")
    assert alarm is not None
    assert (alarm.active, alarm.acknowledged) == (True, True)
    room.spend(PERIOD, all=room.hear)
    assert room.alarms.listed() == []
    room.spend(3.0)
    alarm = room.find("runtime_silent")
    assert alarm is not None
    assert not alarm.acknowledged


def test_what_has_just_been_started_may_be_silent_for_longer(room: Room) -> None:
    room.run_all()
    room.spend(STARTING_SECONDS - PERIOD)
    assert room.active() == set()
    room.spend(1.0)
    assert "runtime_silent" in room.active()


def test_a_server_that_was_held_up_does_not_blame_the_others(room: Room) -> None:
    room.clock.forward(30.0)
    room.watchdog.check_once()
    assert room.active() == set()
    room.spend(1.0, all=room.hear)
    assert room.told == []


def test_a_runtime_that_stays_silent_is_ended_once_and_no_other_part(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[str] = []
    monkeypatch.setattr(
        ManagedProcess, "end_hung", lambda part, problem: ended.append(f"{part.command.name} {problem}")
    )
    last_heard = room.clock.now()
    while not ended:
        room.spend(PERIOD)
    assert HUNG_SECONDS <= room.clock.now() - last_heard <= HUNG_SECONDS + 2 * PERIOD
    assert ended == ["runtime said nothing for 10 s, and was ended"]
    room.spend(HUNG_SECONDS - SILENT_SECONDS - PERIOD)
    assert len(ended) == 1
    room.spend(PERIOD, all=room.hear)
    room.spend(HUNG_SECONDS - PERIOD)
    assert len(ended) == 1


def test_a_server_that_is_held_up_again_and_again_ends_nobody(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[ManagedProcess] = []
    monkeypatch.setattr(ManagedProcess, "end_hung", lambda part, _: ended.append(part))
    for _ in range(20):
        room.clock.forward(30.0)
        room.watchdog.check_once()
        room.spend(2 * PERIOD)
        room.spend(PERIOD, all=room.hear)
    assert ended == []


@pytest.mark.parametrize("name", DOWN)
def test_a_part_that_has_ended_is_an_alarm_until_it_runs_again(room: Room, name: str) -> None:
    room.parts[name]._fail("was ended by signal SIGKILL", 0.0)
    room.alarms.begin(DOWN[name], "It was ended.")
    room.spend(PERIOD, all=room.hear)
    assert room.active() == {DOWN[name]}
    room.parts[name]._set("running")
    room.spend(PERIOD, all=room.hear)
    alarm = room.find(DOWN[name])
    assert alarm is not None
    assert (alarm.active, alarm.what) == (False, "It was ended.")


def test_a_part_that_is_paused_is_not_wrong(room: Room) -> None:
    for part in room.parts.values():
        part._set("paused")
    room.spend(20.0)
    assert room.alarms.listed() == []


def test_a_disk_that_fills_up(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    disk = SimpleNamespace()
    monkeypatch.setattr(shutil, "disk_usage", lambda _: disk)
    for disk.total, disk.free, low in (
        (10**12, 499_000_000, True),
        (10**12, 501_000_000, False),
        (10**9, 49_000_000, True),
        (10**9, 51_000_000, False),
    ):
        room.spend(PERIOD, all=room.hear)
        assert room.active() == ({"disk_low"} if low else set())


def test_a_database_that_fails(room: Room, store: Store) -> None:
    store.failing = "the disk is full"
    room.spend(PERIOD, all=room.hear)
    assert room.active() == {"store_failing"}
    store.failing = None
    room.spend(PERIOD, all=room.hear)
    assert room.active() == set()


def test_every_fault_says_the_likely_cause_and_what_to_do() -> None:
    for fault in FAULTS.values():
        assert fault.cause.endswith(".")
        assert fault.remedy.endswith(".")
