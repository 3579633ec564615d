import asyncio
from dataclasses import replace

import pytest

from robot_runtime.transport.blocks import Block
from server.health.monitor import GRACE_SECONDS
from server.platform.errors import UnavailableError
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.blocks import link_block, state_block, truth_block
from tests.server.health.monitor_rig import MonitorRig


@pytest.fixture
def rig(settings: Settings, store: Store) -> MonitorRig:
    return MonitorRig(settings, store, "board", "runtime", "simulator")


def test_all_is_well_while_everything_is_received(rig: MonitorRig) -> None:
    rig.run_all()
    assert rig.status == "starting"
    for number in range(5):
        rig.receive(number)
        rig.clock.forward(1)
    assert rig.status == "ok"
    assert rig.text("link") == "connected"


def test_a_silent_process_is_starting_at_first_and_then_failed(rig: MonitorRig) -> None:
    rig.run_all()
    rig.clock.forward(GRACE_SECONDS - 0.1)
    assert rig.status == "starting"
    rig.clock.forward(0.2)
    assert [rig.state(name) for name in ("runtime", "simulator")] == ["failed"] * 2


def test_what_the_runtime_alone_knows_is_unknown_while_it_says_nothing(rig: MonitorRig) -> None:
    rig.run_all()
    rig.receive(0)
    rig.receive(1)
    assert [rig.state(name) for name in ("link", "board", "camera")] == ["ok"] * 3
    rig.clock.forward(GRACE_SECONDS + 0.1)
    assert [rig.state(name) for name in ("link", "board", "camera")] == ["unknown"] * 3
    assert rig.text("board") == "The runtime sends nothing."
    # A board whose process has ended is no riddle.
    rig.parts["board"]._set("failed")
    assert rig.state("board") == "failed"


def test_a_mission_that_runs_is_unknown_while_the_runtime_says_nothing(rig: MonitorRig) -> None:
    rig.run_all()
    rig.monitor.require_heard()
    rig.receive(0)
    rig.monitor.require_heard()
    rig.clock.forward(5.0)
    with pytest.raises(UnavailableError, match="said nothing for 5 s"):
        rig.monitor.require_heard()


def test_it_is_alive_unless_the_database_or_the_runtime_fails(rig: MonitorRig, store: Store) -> None:
    rig.run_all()
    rig.clock.forward(60)
    assert not rig.monitor.alive
    rig.monitor.see(state_block(0))
    assert rig.monitor.alive
    store.failing = "the disk is full"
    assert not rig.monitor.alive
    store.failing = None
    rig.clock.forward(2.6)
    assert not rig.monitor.alive


def test_a_state_of_long_ago_is_not_the_present_one(rig: MonitorRig) -> None:
    rig.run_all()
    assert rig.monitor.silence() is None
    rig.receive(0, armed=True)
    rig.clock.forward(2.4)
    assert rig.monitor.silence() is None
    rig.clock.forward(5.0)
    assert rig.monitor.silence() == pytest.approx(7.4)
    rig.receive(1)
    assert rig.monitor.silence() is None


@pytest.mark.parametrize(
    ("name", "limit", "state"),
    [("runtime", 2.5, "failed"), ("board", 3.0, "unknown"), ("simulator", 2.0, "failed")],
)
def test_received_data_becomes_stale(rig: MonitorRig, name: str, limit: float, state: str) -> None:
    rig.run_all()
    rig.clock.forward(60)
    rig.receive(0)
    rig.receive(1)
    rig.clock.forward(limit - 0.01)
    assert rig.state(name) == "ok"
    rig.clock.forward(0.02)
    assert rig.state(name) == state


def test_a_silent_board_has_failed_even_while_link_statistics_arrive(rig: MonitorRig) -> None:
    rig.run_all()
    rig.clock.forward(60)
    for number in range(5):
        rig.monitor.see(link_block(number, 500 + min(number, 1)))
        rig.clock.forward(1)
    assert rig.state("board") == "failed"


def test_a_restarted_byte_counter_counts_as_received_bytes(rig: MonitorRig) -> None:
    rig.run_all()
    rig.monitor.see(link_block(0, 500_000))
    rig.clock.forward(60)
    rig.monitor.see(link_block(0, 0))
    assert rig.state("board") == "failed"
    rig.monitor.see(link_block(0, 500_000))
    rig.clock.forward(60)
    rig.monitor.see(link_block(0, 60))
    assert rig.state("board") == "ok"


def test_the_link_s_state_is_the_runtime_s_text(rig: MonitorRig) -> None:
    rig.run_all()
    rig.clock.forward(60)
    rig.receive(0, connected=False, connection="The definitions differ. Upload the firmware.")
    assert (rig.state("link"), rig.text("link")) == (
        "failed",
        "The definitions differ. Upload the firmware.",
    )


def test_an_ended_process_has_failed_whatever_was_received(rig: MonitorRig) -> None:
    rig.run_all()
    rig.receive(0)
    rig.receive(1)
    for name, part in rig.parts.items():
        part.problem = "has ended with exit status 1"
        part._set("failed")
        assert (rig.state(name), rig.text(name)) == ("failed", "It has ended with exit status 1.")
    assert rig.status == "failed"


def test_a_restarted_process_is_starting_until_it_sends(rig: MonitorRig) -> None:
    rig.run_all()
    rig.clock.forward(60)
    rig.receive(0)
    rig.receive(1)
    assert rig.status == "ok"
    rig.clock.forward(0.1)
    for name in ("simulator", "runtime", "board"):
        for state in ("failed", "waiting", "running"):
            rig.parts[name]._set(state)
            assert rig.state(name) == ("failed" if state == "failed" else "starting"), state
    rig.clock.forward(0.1)
    rig.receive(2)
    assert [rig.state(name) for name in ("simulator", "runtime", "link", "board")] == ["ok"] * 4


def test_a_reserved_board_is_absent_and_not_failed(rig: MonitorRig) -> None:
    rig.run_all()
    rig.clock.forward(60)
    rig.monitor.see(truth_block(0))
    asyncio.run(rig.parts["runtime"].pause("The board is lent."))
    for name in ("runtime", "link", "board"):
        assert (rig.state(name), rig.text(name)) == ("absent", "The board is lent.")
    assert rig.status == "ok"
    rig.parts["board"].problem = "has ended"
    rig.parts["board"]._set("failed")
    assert rig.state("board") == "failed"


def test_a_board_without_its_firmware_is_reported_until_it_answers(rig: MonitorRig) -> None:
    rig.run_all()
    rig.clock.forward(60)
    rig.monitor.firmware_away = "The firmware is not on the board."
    rig.receive(0, connected=False, connection="no answer")
    assert (rig.state("link"), rig.text("link")) == ("failed", "The firmware is not on the board.")
    rig.receive(1)
    assert (rig.state("link"), rig.text("link")) == ("ok", "connected")


def test_a_real_robot_has_no_simulator(settings: Settings, store: Store) -> None:
    rig = MonitorRig(replace(settings, robot=replace(settings.robot, mode="robot")), store, "runtime")
    rig.run_all()
    rig.receive(0)
    rig.receive(1)
    assert (rig.state("simulator"), rig.state("board"), rig.status) == ("absent", "ok", "ok")


def test_a_failing_database_is_reported_with_the_reason(rig: MonitorRig, store: Store) -> None:
    store.failing = "the disk is full"
    assert (rig.state("database"), rig.text("database")) == (
        "failed",
        "Nothing can be stored: the disk is full.",
    )


def test_an_invalid_state_counts_as_none(rig: MonitorRig) -> None:
    block = state_block(0)
    for payload in (b"", b"[]", b"[3]", b"{}", b"[" * 100_000):
        rig.monitor.see(Block(block.topic, 1, 0, bytes(12) + payload))
        assert rig.monitor.state() is None
        assert rig.state("link") in ("starting", "failed")
