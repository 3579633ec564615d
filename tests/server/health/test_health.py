import asyncio
from dataclasses import replace
from typing import Any

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.transport.blocks import Block
from server.health.monitor import GRACE_SECONDS, HealthMonitor
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.logs import ProcessLog
from server.processes.supervisor import ManagedProcess, ProcessCommand
from tests.server.blocks import link_block, state_block, truth_block


class Bench:
    """A watch with parts whose state is set by hand."""

    def __init__(self, settings: Settings, store: Store, *names: str) -> None:
        self.clock = SimulatedClock(1000.0)
        self.parts = {
            name: ManagedProcess(
                ProcessCommand(name, name, ()),
                ProcessLog(settings.data.logs),
                settings.data.run,
                self.clock,
                lambda *_: None,
            )
            for name in names
        }
        self.monitor = HealthMonitor(settings, self.clock, store, self.parts)  # type: ignore[arg-type]

    def run_all(self) -> None:
        for part in self.parts.values():
            part._set("running")

    def hear(self, number: int, **state: Any) -> None:
        """Everything that comes while all is well."""
        for block in (
            state_block(number, **state),
            link_block(number, 100 * number + 1),
            truth_block(number),
        ):
            self.monitor.see(block)

    def state(self, name: str) -> str:
        return next(part.state for part in self.monitor.health().parts if part.name == name)

    def text(self, name: str) -> str:
        return next(part.text for part in self.monitor.health().parts if part.name == name)

    @property
    def status(self) -> str:
        return self.monitor.health().status


@pytest.fixture
def bench(settings: Settings, store: Store) -> Bench:
    return Bench(settings, store, "board", "runtime", "simulator")


def test_all_is_well_while_everything_keeps_coming(bench: Bench) -> None:
    bench.run_all()
    assert bench.status == "starting"
    for number in range(5):
        bench.hear(number)
        bench.clock.forward(1)
    assert bench.status == "ok"
    assert bench.text("link") == "connected"


def test_a_silent_part_is_starting_at_first_and_then_failed(bench: Bench) -> None:
    bench.run_all()
    bench.clock.forward(GRACE_SECONDS - 0.1)
    assert bench.status == "starting"
    bench.clock.forward(0.2)
    assert [bench.state(name) for name in ("runtime", "link", "board", "simulator")] == ["failed"] * 4


@pytest.mark.parametrize(("name", "limit"), [("runtime", 2.5), ("board", 3.0), ("simulator", 2.0)])
def test_what_was_heard_grows_old(bench: Bench, name: str, limit: float) -> None:
    bench.run_all()
    bench.clock.forward(60)
    bench.hear(0)
    bench.hear(1)
    bench.clock.forward(limit - 0.01)
    assert bench.state(name) == "ok"
    bench.clock.forward(0.02)
    assert bench.state(name) == "failed"


def test_a_board_that_sends_no_more_bytes_has_failed_though_the_link_is_reported(bench: Bench) -> None:
    bench.run_all()
    bench.clock.forward(60)
    for number in range(5):
        bench.monitor.see(link_block(number, 500 + min(number, 1)))
        bench.clock.forward(1)
    assert bench.state("board") == "failed"


def test_the_link_speaks_in_the_words_of_the_runtime(bench: Bench) -> None:
    bench.run_all()
    bench.clock.forward(60)
    bench.hear(0, connected=False, connection="The definitions differ. Upload the firmware.")
    assert (bench.state("link"), bench.text("link")) == (
        "failed",
        "The definitions differ. Upload the firmware.",
    )


def test_a_part_that_ended_has_failed_whatever_was_heard(bench: Bench) -> None:
    bench.run_all()
    bench.hear(0)
    bench.hear(1)
    for name, part in bench.parts.items():
        part.problem = "has ended with exit status 1"
        part._set("failed")
        assert (bench.state(name), bench.text(name)) == ("failed", "It has ended with exit status 1.")
    assert bench.status == "failed"


def test_what_is_lent_is_absent_and_not_failed(bench: Bench) -> None:
    bench.run_all()
    bench.clock.forward(60)
    bench.monitor.see(truth_block(0))
    asyncio.run(bench.parts["runtime"].pause("The board is lent."))
    for name in ("runtime", "link", "board"):
        assert (bench.state(name), bench.text(name)) == ("absent", "The board is lent.")
    assert bench.status == "ok"
    bench.parts["board"].problem = "has ended"
    bench.parts["board"]._set("failed")
    assert bench.state("board") == "failed"


def test_a_board_without_its_firmware_is_told_until_it_answers(bench: Bench) -> None:
    bench.run_all()
    bench.clock.forward(60)
    bench.monitor.firmware_away = "The firmware is not on the board."
    bench.hear(0, connected=False, connection="no answer")
    assert (bench.state("link"), bench.text("link")) == ("failed", "The firmware is not on the board.")
    bench.hear(1)
    assert (bench.state("link"), bench.text("link")) == ("ok", "connected")


def test_a_real_robot_has_no_simulator(settings: Settings, store: Store) -> None:
    bench = Bench(replace(settings, mode="robot"), store, "runtime")
    bench.run_all()
    bench.hear(0)
    bench.hear(1)
    assert (bench.state("simulator"), bench.state("board"), bench.status) == ("absent", "ok", "ok")


def test_a_database_that_fails_is_told_with_its_reason(bench: Bench, store: Store) -> None:
    store.failing = "the disk is full"
    assert (bench.state("database"), bench.text("database")) == (
        "failed",
        "Nothing can be stored: the disk is full.",
    )


def test_a_state_that_cannot_be_read_is_none(bench: Bench) -> None:
    block = state_block(0)
    for payload in (b"", b"[]", b"[3]", b"{}", b"[" * 100_000):
        bench.monitor.see(Block(block.topic, 1, 0, bytes(12) + payload))
        assert bench.monitor.state() is None
        assert bench.state("link") in ("starting", "failed")
