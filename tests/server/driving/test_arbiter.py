import asyncio
from dataclasses import replace
from typing import Any

import pytest

import server.driving.arbiter as arbiter_module
import server.driving.clients as clients_module
from robot_runtime.clock import SteadyClock
from robot_runtime.errors import RefusedError
from server.driving.arbiter import RELOAD_SECONDS, ControlArbiter
from server.driving.clients import PROGRAM_SECONDS
from server.driving.lease import NotInControlError
from server.http.sign_in.identity import Identity
from tests.server.driving.people import ANNA, BEN, VERA, ArbiterRig
from tests.server.waiting import SECONDS

SCRIPT = Identity(5, "script", "operator", "program")


def test_every_client_is_notified_of_every_change() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    with arbiter.page(ANNA) as anna, arbiter.page(BEN) as ben:
        arbiter.take(anna)
        first = {"op": "control", "epoch": 1_000_001, "holder": {"client": anna.number, "name": "Anna"}}
        assert seen.messages[-1] == first
        arbiter.take(ben, over=True)
        theirs = {"client": ben.number, "name": "Ben"}
        assert seen.messages[-1] == first | {"epoch": 1_000_002, "holder": theirs}
        arbiter.release(ben)
        assert seen.messages[-1] == first | {"epoch": 1_000_003, "holder": None}
        arbiter.take(anna)
    assert seen.messages[-1] == first | {"epoch": 1_000_005, "holder": None}
    seen.clock.forward(RELOAD_SECONDS)
    arbiter.expire()
    assert seen.noted == [
        "“Anna” took control.",
        "“Ben” took over control from “Anna”.",
        "“Ben” released control. Nobody has it now.",
        "“Anna” took control.",
        "“Anna” left, and nobody has control now.",
    ]


def test_a_reloaded_page_has_control_again_without_an_entry() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    with arbiter.page(ANNA) as anna:
        arbiter.take(anna)
        held = arbiter.lease.epoch
    # Its sticks count no longer from the moment when it closes.
    assert (seen.messages[-1]["holder"], arbiter.lease.epoch) == (None, held + 1)
    seen.clock.forward(RELOAD_SECONDS - 0.1)
    with arbiter.page(ANNA) as anna:
        arbiter.take(anna)
        assert seen.messages[-1]["holder"] == {"client": anna.number, "name": "Anna"}
        seen.clock.forward(RELOAD_SECONDS)
        arbiter.expire()
        assert seen.noted == ["“Anna” took control."]


@pytest.mark.parametrize("other", [BEN, SCRIPT, Identity(ANNA.device, "Anna", "operator", "program")])
def test_the_leaving_of_a_page_is_recorded_before_another_client_takes_control(other: Identity) -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    with arbiter.page(ANNA) as anna:
        arbiter.take(anna)
    if other is BEN:
        with arbiter.page(BEN) as ben:
            arbiter.take(ben)
    else:
        arbiter.take(arbiter.open_program(other))
    assert seen.noted[1:3] == [
        "“Anna” left, and nobody has control now.",
        f"“{other.name}” took control.",
    ]


@pytest.mark.parametrize("signed_out", [False, True])
def test_a_page_that_returns_too_late_or_was_signed_out_has_lost_control(signed_out: bool) -> None:
    seen = ArbiterRig()
    with seen.arbiter.page(ANNA) as anna:
        seen.arbiter.take(anna)
    if signed_out:
        seen.arbiter.dismiss(ANNA.device)
    else:
        seen.clock.forward(RELOAD_SECONDS)
    with seen.arbiter.page(ANNA) as anna:
        seen.arbiter.take(anna)
        remaining, taken = "“Anna” left, and nobody has control now.", "“Anna” took control."
        assert seen.noted == [taken, remaining, taken]


def test_control_that_another_client_has_is_only_taken_over_explicitly() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    with arbiter.page(ANNA) as anna, arbiter.page(BEN) as ben:
        arbiter.take(anna)
        with pytest.raises(
            RefusedError, match=r"Control is with Anna\. Agree with them, then take it over\."
        ):
            arbiter.take(ben)
        arbiter.take(anna)
        assert (arbiter.lease.holder, arbiter.lease.epoch) == (anna.number, 1_000_001)
        arbiter.take(ben, over=True)
        assert arbiter.lease.holder == ben.number


def test_a_restarted_server_continues_above_the_last_epoch() -> None:
    seen = ArbiterRig()
    with seen.arbiter.page(ANNA) as anna:
        for _ in range(500):
            seen.arbiter.take(anna)
            seen.arbiter.release(anna)
    seen.clock.forward(1.5)
    fresh = ControlArbiter(seen.clock, seen.messages.append, print, print, print)
    assert fresh.lease.epoch > seen.arbiter.lease.epoch


def test_a_viewer_neither_takes_control_nor_takes_it_over() -> None:
    seen = ArbiterRig()
    with seen.arbiter.page(VERA) as vera, seen.arbiter.page(ANNA) as anna:
        with pytest.raises(RefusedError, match="Only operators"):
            seen.arbiter.take(vera)
        seen.arbiter.take(anna)
        with pytest.raises(RefusedError, match="Only operators"):
            seen.arbiter.take(vera, over=True)
        assert seen.arbiter.lease.holder == anna.number


def test_a_refusal_names_the_holder_and_the_remedy() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    with arbiter.page(ANNA) as anna, arbiter.page(BEN) as ben:
        with pytest.raises(NotInControlError, match=r"Nobody has control\. Take control first\."):
            arbiter.require(anna)
        arbiter.take(anna)
        arbiter.require(anna)
        for client in (ben, None):
            with pytest.raises(NotInControlError, match=r"Control is with Anna\. Agree with them"):
                arbiter.require(client)


def test_two_pages_of_one_browser_are_two_clients() -> None:
    seen = ArbiterRig()
    with seen.arbiter.page(ANNA) as first, seen.arbiter.page(ANNA) as other:
        seen.arbiter.take(first)
        with pytest.raises(NotInControlError):
            seen.arbiter.require(seen.arbiter.clients.find(ANNA, other.key))
        seen.arbiter.require(seen.arbiter.clients.find(ANNA, first.key))
        # Without a key a page's browser has nothing.
        assert seen.arbiter.clients.find(ANNA, None) is None


def test_a_key_is_valid_only_for_the_identity_that_received_it() -> None:
    seen = ArbiterRig()
    clients = seen.arbiter.clients
    seen.arbiter.open_program(SCRIPT)
    with seen.arbiter.page(ANNA) as anna:
        assert clients.find(BEN, anna.key) is None
        assert clients.find(ANNA, "µ") is None
        assert clients.find(ANNA, "") is None
        assert clients.find(ANNA, anna.key) is anna
        assert clients.find(SCRIPT, "") is None


def test_programs_with_one_token_are_one_client_while_they_send_requests() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    assert arbiter.clients.find(SCRIPT, None) is None
    script = arbiter.open_program(SCRIPT)
    assert arbiter.open_program(SCRIPT) is script
    arbiter.take(script)
    for _ in range(5):
        seen.clock.forward(PROGRAM_SECONDS - 0.1)
        assert arbiter.clients.find(SCRIPT, None) is script
    seen.clock.forward(PROGRAM_SECONDS)
    assert arbiter.clients.find(SCRIPT, None) is None
    assert arbiter.state().holder is None
    assert arbiter.clients.get(script.number) is None
    assert arbiter.open_program(SCRIPT).number > script.number


def test_signing_out_or_becoming_a_viewer_ends_clients_and_control() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    script = arbiter.open_program(SCRIPT)
    arbiter.dismiss(SCRIPT.device)
    assert arbiter.clients.get(script.number) is None
    with arbiter.page(ANNA) as anna, arbiter.page(ANNA) as other, arbiter.page(BEN) as ben:
        arbiter.take(anna)
        arbiter.dismiss(ANNA.device)
        assert seen.messages[-1]["holder"] is None
        assert arbiter.clients.find(ANNA, anna.key) is None
        # Its sockets may live for a moment longer.
        for client in (anna, other):
            arbiter.drive(client, seen.drive())
        assert (arbiter.lease.holder, seen.driven) == (None, [])
        arbiter.take(ben)
    assert arbiter.lease.holder is None


def test_control_that_nobody_gave_back_is_audited_with_the_reason() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    with arbiter.page(ANNA) as anna, arbiter.page(BEN):
        arbiter.take(anna)
        arbiter.release(anna)
        assert seen.lost == []
        arbiter.take(anna)
    assert seen.lost == [("Anna", "its page was closed, or its connection is gone")]
    with arbiter.page(ANNA) as anna:
        arbiter.take(anna)
        arbiter.dismiss(BEN.device)
        arbiter.dismiss(ANNA.device)
    assert seen.lost[1:] == [("Anna", "it was signed out, or has another role")]
    arbiter.take(arbiter.open_program(SCRIPT))
    seen.clock.forward(10.1)
    arbiter.expire()
    assert seen.lost[2:] == [("script", "it asked nothing for 10 s")]


async def test_the_leaving_of_a_page_is_recorded_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    # Who slept for the whole time would be too late however long the test waits.
    monkeypatch.setattr(arbiter_module, "RELOAD_SECONDS", 10 * SECONDS)
    noted: list[str] = []

    arbiter = ControlArbiter(SteadyClock(), print, print, noted.append, print)
    with arbiter.page(ANNA) as anna:
        arbiter.take(anna)
    assert arbiter._departure is not None
    # As if nearly all of its time had passed.
    arbiter._departure = replace(arbiter._departure, due=SteadyClock().now() + 0.05)
    task = asyncio.create_task(arbiter.run())
    async with asyncio.timeout(SECONDS):
        while len(noted) < 2:
            await asyncio.sleep(0)
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
    assert noted[-1] == "“Anna” left, and nobody has control now."


async def test_the_silence_of_a_program_is_recorded_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clients_module, "PROGRAM_SECONDS", 10 * SECONDS)
    notices: list[dict[str, Any]] = []
    noted: list[str] = []

    clock = SteadyClock()
    arbiter = ControlArbiter(clock, notices.append, print, noted.append, print)
    task = asyncio.create_task(arbiter.run())
    script = arbiter.open_program(SCRIPT)
    arbiter.take(script)
    assert notices[-1]["holder"] == {"client": script.number, "name": "script"}
    # As if nearly all of its time had passed.
    script.until = clock.now() + 0.05
    arbiter.announce()
    async with asyncio.timeout(SECONDS):
        while notices[-1]["holder"] is not None:
            await asyncio.sleep(0)
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
    assert noted[-1] == "“script” left, and nobody has control now."


def test_a_program_in_control_watches_until_it_falls_silent_and_a_page_by_its_socket() -> None:
    seen = ArbiterRig()
    arbiter = seen.arbiter
    with arbiter.page(ANNA) as anna:
        arbiter.take(anna)
        assert arbiter.programs_in_control() == 0
        arbiter.take(arbiter.open_program(SCRIPT), over=True)
        assert arbiter.programs_in_control() == 1
        seen.clock.forward(PROGRAM_SECONDS)
        assert arbiter.programs_in_control() == 0
