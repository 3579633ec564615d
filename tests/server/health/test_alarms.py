import errno
import shutil
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from robot_runtime.contract.documents import Alarm, Event
from robot_runtime.control.alarms import Alarms
from server.app import create_app
from server.health.faults import SERVER_FAULTS
from server.health.watchdog import (
    DOWN,
    HUNG_SECONDS,
    PERIOD,
    SILENT_SECONDS,
    STARTING_SECONDS,
    SUPPLY_SECONDS,
    Watchdog,
)
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.managed_process import ManagedProcess
from server.recording.recorder import Recorder
from tests.server.blocks import state_block
from tests.server.health.monitor_rig import MonitorRig
from tests.server.new_database import place_with_samples
from tests.server.waiting import until


class AlarmRig(MonitorRig):
    """A health monitor with the server's alarms."""

    def __init__(self, settings: Settings, store: Store) -> None:
        super().__init__(settings, store, *DOWN)
        self.events: list[Event] = []
        self.alarms = Alarms(self.clock, SERVER_FAULTS, self.events.append)
        self.watchdog = Watchdog(
            settings,
            self.clock,
            self.monitor,
            self.parts,  # type: ignore[arg-type]
            store,
            self.alarms,
            lambda: self.throttled,
        )
        self.throttled: int | None = 0

    def spend(self, seconds: float, **answer: Any) -> None:
        """Advance the clock; each callable of `said` gets every step's number."""
        end = self.clock.now() + seconds
        while self.clock.now() < end:
            self.clock.forward(PERIOD)
            for hear in answer.values():
                hear(round(self.clock.now() / PERIOD))
            self.watchdog.check_once()

    def find(self, fault: str) -> Alarm | None:
        return next((alarm for alarm in self.alarms.listed() if alarm.fault == fault), None)

    def active(self) -> set[str]:
        return {alarm.fault for alarm in self.alarms.listed() if alarm.active}


@pytest.fixture
def rig(settings: Settings, store: Store) -> AlarmRig:
    rig = AlarmRig(settings, store)
    rig.run_all()
    rig.spend(1.0, all=rig.receive)
    return rig


def test_all_is_well(rig: AlarmRig) -> None:
    rig.spend(5.0, all=rig.receive)
    assert (rig.alarms.listed(), rig.events) == ([], [])


def test_a_silent_process_is_an_alarm_until_it_sends_again(rig: AlarmRig) -> None:
    last_heard = rig.clock.now()
    while "runtime_silent" not in rig.active():
        rig.spend(PERIOD)
    assert rig.clock.now() - last_heard <= SILENT_SECONDS + 2 * PERIOD
    assert rig.active() == {"runtime_silent", "simulator_silent"}
    rig.spend(PERIOD, all=rig.receive)
    assert rig.active() == set()
    alarm = rig.find("runtime_silent")
    assert alarm is not None
    assert (alarm.active, alarm.acknowledged) == (False, False)
    assert [(event.kind, event.severity) for event in rig.events] == [
        ("runtime_silent", "alarm"),
        ("simulator_silent", "caution"),
        ("alarm_over", "info"),
        ("alarm_over", "info"),
    ]
    rig.alarms.acknowledge()
    assert rig.alarms.listed() == []


@pytest.mark.parametrize("active", [True, False])
def test_a_silent_simulator_that_the_runtime_has_noticed_is_no_second_alarm(
    rig: AlarmRig, active: bool
) -> None:
    alarm = {"fault": "simulator_silent", "active": active}
    rig.spend(3.0, runtime=lambda number: rig.monitor.see(state_block(number, alarms=[alarm])))
    assert rig.active() == (set() if active else {"simulator_silent"})


def test_an_alarm_says_what_follows_from_it_and_when_it_was_over(rig: AlarmRig) -> None:
    rig.spend(3.0)
    (silent,) = [alarm for alarm in rig.alarms.listed() if alarm.fault == "runtime_silent"]
    assert (silent.until, "runtime_stalled" in silent.consequences) == (None, True)
    last_seen = rig.clock.now()
    rig.spend(2.0, all=rig.receive)
    (silent,) = [alarm for alarm in rig.alarms.listed() if alarm.fault == "runtime_silent"]
    assert silent.until == pytest.approx(last_seen)


def test_an_acknowledged_alarm_disappears_with_its_fault(rig: AlarmRig) -> None:
    rig.spend(3.0)
    rig.alarms.acknowledge()
    alarm = rig.find("runtime_silent")
    assert alarm is not None
    assert (alarm.active, alarm.acknowledged) == (True, True)
    rig.spend(PERIOD, all=rig.receive)
    assert rig.alarms.listed() == []
    rig.spend(3.0)
    alarm = rig.find("runtime_silent")
    assert alarm is not None
    assert not alarm.acknowledged


def test_a_process_that_has_just_started_may_be_silent_for_longer(rig: AlarmRig) -> None:
    rig.run_all()
    rig.spend(STARTING_SECONDS - PERIOD)
    assert rig.active() == set()
    rig.spend(1.0)
    assert "runtime_silent" in rig.active()


def test_after_a_stall_of_the_server_other_processes_are_not_blamed(rig: AlarmRig) -> None:
    rig.clock.forward(30.0)
    rig.watchdog.check_once()
    assert rig.active() == set()
    rig.spend(1.0, all=rig.receive)
    assert rig.events == []


def test_only_a_silent_runtime_is_killed_and_only_once(
    rig: AlarmRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[str] = []
    monkeypatch.setattr(
        ManagedProcess, "end_hung", lambda part, problem: ended.append(f"{part.command.name} {problem}")
    )
    last_heard = rig.clock.now()
    while not ended:
        rig.spend(PERIOD)
    assert HUNG_SECONDS <= rig.clock.now() - last_heard <= HUNG_SECONDS + 2 * PERIOD
    assert ended == ["runtime said nothing for 10 s, and was ended"]
    rig.spend(HUNG_SECONDS - SILENT_SECONDS - PERIOD)
    assert len(ended) == 1
    rig.spend(PERIOD, all=rig.receive)
    rig.spend(HUNG_SECONDS - PERIOD)
    assert len(ended) == 1


def test_repeated_stalls_of_the_server_kill_no_process(
    rig: AlarmRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[ManagedProcess] = []
    monkeypatch.setattr(ManagedProcess, "end_hung", lambda part, _: ended.append(part))
    for _ in range(20):
        rig.clock.forward(30.0)
        rig.watchdog.check_once()
        rig.spend(2 * PERIOD)
        rig.spend(PERIOD, all=rig.receive)
    assert ended == []


@pytest.mark.parametrize("name", DOWN)
def test_an_ended_process_is_an_alarm_until_it_runs_again(rig: AlarmRig, name: str) -> None:
    rig.parts[name]._fail("was ended by signal SIGKILL", 0.0)
    rig.alarms.begin(DOWN[name], "It was ended.")
    rig.spend(PERIOD, all=rig.receive)
    assert rig.active() == {DOWN[name]}
    rig.parts[name]._set("running")
    rig.spend(PERIOD, all=rig.receive)
    alarm = rig.find(DOWN[name])
    assert alarm is not None
    assert (alarm.active, alarm.what) == (False, "It was ended.")


def test_a_paused_process_is_no_fault(rig: AlarmRig) -> None:
    for part in rig.parts.values():
        part._set("paused")
    rig.spend(20.0)
    assert rig.alarms.listed() == []


def test_a_full_disk_is_an_alarm(rig: AlarmRig, monkeypatch: pytest.MonkeyPatch) -> None:
    disk = SimpleNamespace()
    monkeypatch.setattr(shutil, "disk_usage", lambda _: disk)
    for disk.total, disk.free, low in (
        (10**12, 501_000_000, False),
        (10**12, 499_000_000, True),
        (10**12, 599_000_000, True),
        (10**12, 601_000_000, False),
        (10**9, 51_000_000, False),
        (10**9, 49_000_000, True),
        (10**9, 59_000_000, True),
        (10**9, 61_000_000, False),
    ):
        rig.spend(PERIOD, all=rig.receive)
        assert rig.active() == ({"disk_low"} if low else set())


def test_a_failing_database_is_an_alarm(rig: AlarmRig, store: Store) -> None:
    store.failing = "the disk is full"
    rig.spend(PERIOD, all=rig.receive)
    assert rig.active() == {"store_failing"}
    store.failing = None
    rig.spend(PERIOD, all=rig.receive)
    assert rig.active() == set()


def test_a_disk_that_is_gone_is_an_alarm_and_the_watch_goes_on(
    rig: AlarmRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: object) -> None:
        raise OSError(errno.EIO, "Input/output error")

    with monkeypatch.context() as gone:
        gone.setattr(shutil, "disk_usage", refuse)
        rig.spend(PERIOD, all=rig.receive)
        assert rig.active() == {"store_failing"}
        rig.spend(2 * SILENT_SECONDS)
        assert "runtime_silent" in rig.active()
    rig.spend(PERIOD, all=rig.receive)
    assert rig.active() == set()


def test_a_supply_that_is_too_low_is_an_alarm_also_for_a_moment(rig: AlarmRig) -> None:
    notices = []
    for bits in (0x0, 0x10001, 0x10000, 0x10000, None):
        rig.throttled = bits
        rig.spend(SUPPLY_SECONDS, all=rig.receive)
        notices.append("undervoltage" in rig.active())
    assert notices == [False, True, False, False, False]
    rig.throttled = 0x0
    rig.spend(SUPPLY_SECONDS, all=rig.receive)
    rig.throttled = 0x10000
    rig.spend(SUPPLY_SECONDS, all=rig.receive)
    assert rig.active() == {"undervoltage"}


def test_a_damaged_configuration_is_an_alarm(settings: Settings, store: Store) -> None:
    rig = AlarmRig(replace(settings, configuration_problem="robot.toml cannot be read."), store)
    rig.run_all()
    rig.spend(1.0, all=rig.receive)
    alarm = rig.find("configuration_damaged")
    assert alarm is not None
    assert (alarm.active, alarm.what) == (True, "robot.toml cannot be read.")


def test_every_fault_has_a_cause_and_a_remedy() -> None:
    for fault in SERVER_FAULTS.values():
        assert fault.cause.endswith(".")
        assert fault.remedy.endswith(".")


async def test_a_background_task_that_fails_is_an_alarm_and_in_the_log(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    async def fail(_: Recorder) -> None:
        raise TypeError("not a document")

    monkeypatch.setattr(Recorder, "run", fail)
    await place_with_samples(settings.data)
    app = create_app(settings)
    async with app.router.lifespan_context(app):
        alarms: Alarms = app.state.container.services.get(Alarms)
        await until(lambda: any(alarm.fault == "server_task_failed" for alarm in alarms.listed()), "an alarm")
        alarm = next(alarm for alarm in alarms.listed() if alarm.fault == "server_task_failed")
    assert "not a document" in alarm.what
    assert (alarm.severity, alarm.active) == ("alarm", True)
    (record,) = [entry for entry in caplog.records if entry.name == "server.container"]
    assert record.exc_info is not None


async def test_a_restarted_server_raises_an_alarm(settings: Settings) -> None:
    async def started(ended: str) -> list[tuple[str, str, str]]:
        await place_with_samples(settings.data)
        app = create_app(settings)
        app.state.ended = ended
        async with app.router.lifespan_context(app):
            alarms = app.state.container.services.get(Alarms).listed()
        return [
            (alarm.fault, alarm.what, alarm.severity) for alarm in alarms if alarm.fault == "server_restarted"
        ]

    assert await started("") == []
    answer = await started("The server was ended by signal SIGKILL.")
    text = "The server was ended by signal SIGKILL. It was started again."
    assert answer == [("server_restarted", text, "caution")]
