import asyncio
from dataclasses import replace
from typing import Any

import pytest

from robot_runtime.clock import SteadyClock
from robot_runtime.errors import Refused
from server.features.lease.arbiter import Desk
from server.features.lease.clients import PROGRAM_SECONDS, PROGRAMS_MAX
from server.features.lease.lease import ANSWER_SECONDS, NotInControl
from tests.server.features.lease.people import ANNA, BEN, CLEO, VERA, Seen


def test_everybody_is_told_of_every_change() -> None:
    seen = Seen()
    desk = seen.desk
    with desk.page(ANNA) as anna, desk.page(BEN) as ben:
        desk.take(anna)
        holder = {"seat": anna.number, "name": "Anna"}
        seats = [
            {"seat": one.number, "name": one.identity.name, "role": "operator", "kind": "browser"}
            for one in (anna, ben)
        ]
        nothing = {"request": None, "refused": None}
        first = {"op": "control", "epoch": 1_000_001, "holder": holder, **nothing, "seats": seats}
        assert seen.told[-1] == first
        desk.take(ben)
        request = {"seat": ben.number, "name": "Ben", "until": 1010.0}
        assert seen.told[-1] == first | {"request": request}
        desk.refuse(anna)
        assert seen.told[-1] == first | {"refused": {"seat": ben.number, "until": 1010.0}}
        desk.hand_over(anna, ben.number)
        theirs = {"seat": ben.number, "name": "Ben"}
        assert seen.told[-1] == first | {"epoch": 1_000_002, "holder": theirs}
        assert seen.noted == [
            "“Anna” took control.",
            "“Ben” asked “Anna” for control.",
            "“Anna” kept control, for which “Ben” had asked.",
            "“Anna” handed control over to “Ben”.",
        ]
    assert seen.told[-1] == first | {"epoch": 1_000_003, "holder": None, "seats": []}
    assert seen.noted[4:] == ["“Ben” left, and nobody has control now."]


def test_a_viewer_s_page_is_named_among_the_seats_too() -> None:
    seen = Seen()
    with seen.desk.page(VERA) as vera:
        assert seen.told[-1]["seats"] == [
            {"seat": vera.number, "name": "Vera", "role": "viewer", "kind": "browser"}
        ]


def test_what_is_given_back_and_no_longer_wanted_is_noted() -> None:
    seen = Seen()
    desk = seen.desk
    with desk.page(ANNA) as anna, desk.page(BEN) as ben:
        desk.take(anna)
        desk.take(ben)
        desk.release(ben)
        desk.take(ben)
        desk.release(anna)
        desk.release(ben)
        desk.release(ben)
    assert seen.noted == [
        "“Anna” took control.",
        "“Ben” asked “Anna” for control.",
        "“Ben” asks for control no longer.",
        "“Ben” asked “Anna” for control.",
        "Control passed from “Anna” to “Ben”, who had asked for it.",
        "“Ben” gave control back. Nobody has it now.",
    ]


def test_a_server_that_was_started_again_begins_above_what_the_last_one_reached() -> None:
    seen = Seen()
    with seen.desk.page(ANNA) as anna:
        for _ in range(500):
            seen.desk.take(anna)
            seen.desk.release(anna)
    seen.clock.forward(1.5)
    assert Desk(seen.clock, seen.told.append, print, print).lease.epoch > seen.desk.lease.epoch


def test_a_viewer_neither_takes_nor_is_given_control() -> None:
    seen = Seen()
    with seen.desk.page(VERA) as vera, seen.desk.page(ANNA) as anna:
        with pytest.raises(Refused, match="Only operators"):
            seen.desk.take(vera)
        seen.desk.take(anna)
        with pytest.raises(Refused, match="Vera is a viewer"):
            seen.desk.hand_over(anna, vera.number)
        with pytest.raises(Refused, match="gone"):
            seen.desk.hand_over(anna, 99)
        assert seen.desk.lease.holder == anna.number


def test_it_says_who_has_control_and_what_to_do() -> None:
    seen = Seen()
    desk = seen.desk
    with desk.page(ANNA) as anna, desk.page(BEN) as ben:
        with pytest.raises(NotInControl, match=r"Nobody has control\. Take control first\."):
            desk.require(anna)
        desk.take(anna)
        desk.require(anna)
        for seat in (ben, None):
            with pytest.raises(NotInControl, match=r"Control is with Anna; ask for it\."):
                desk.require(seat)


def test_two_pages_of_one_browser_are_two_seats() -> None:
    seen = Seen()
    with seen.desk.page(ANNA) as one, seen.desk.page(ANNA) as other:
        seen.desk.take(one)
        with pytest.raises(NotInControl):
            seen.desk.require(seen.desk.seats.use(ANNA, other.key))
        seen.desk.require(seen.desk.seats.use(ANNA, one.key))


def test_a_key_counts_only_together_with_the_identity_that_it_was_given_to() -> None:
    seen = Seen()
    with seen.desk.page(ANNA) as anna:
        seen.desk.take(anna)
        assert seen.desk.seats.use(BEN, anna.key) is None
        assert seen.desk.seats.use(ANNA, "µ") is None
        assert seen.desk.seats.use(ANNA, "") is None
        assert seen.desk.seats.use(ANNA, anna.key) is anna


def test_a_program_s_seat_lasts_while_it_is_used() -> None:
    seen = Seen()
    seat = seen.desk.seat_program(ANNA)
    seen.desk.take(seat)
    for _ in range(5):
        seen.clock.forward(PROGRAM_SECONDS - 0.1)
        assert seen.desk.seats.use(ANNA, seat.key) is seat
    seen.clock.forward(PROGRAM_SECONDS)
    assert seen.desk.seats.use(ANNA, seat.key) is None
    assert seen.desk.state().holder is None


def test_a_request_dies_with_the_seat_and_who_asked_gets_what_a_dead_holder_leaves() -> None:
    seen = Seen()
    desk = seen.desk
    program = desk.seat_program(BEN)
    with desk.page(ANNA) as anna:
        desk.take(anna)
        desk.take(program)
        seen.clock.forward(max(PROGRAM_SECONDS, ANSWER_SECONDS))
        assert desk.state().request is None
        assert desk.lease.holder == anna.number
        with desk.page(CLEO) as cleo:
            desk.take(cleo)
            desk.dismiss(ANNA.device)
            assert desk.lease.holder == cleo.number


def test_programs_of_one_device_have_so_many_seats_and_others_need_not_care() -> None:
    seen = Seen()
    for _ in range(PROGRAMS_MAX):
        seen.desk.seat_program(ANNA)
    with pytest.raises(Refused, match="programs of Anna have seats already"):
        seen.desk.seat_program(ANNA)
    seen.desk.seat_program(BEN)
    with seen.desk.page(ANNA):
        seen.clock.forward(PROGRAM_SECONDS)
        seen.desk.seat_program(ANNA)


def test_who_is_signed_out_or_made_a_viewer_has_no_seat_and_no_control_any_more() -> None:
    seen = Seen()
    with seen.desk.page(ANNA) as anna, seen.desk.page(ANNA) as other, seen.desk.page(BEN) as ben:
        seen.desk.take(anna)
        seen.desk.dismiss(ANNA.device)
        assert seen.told[-1]["holder"] is None
        assert seen.desk.seats.use(ANNA, anna.key) is None
        # Its sockets may live for a moment longer.
        for seat in (anna, other):
            seen.desk.drive(seat, seen.drive())
        assert (seen.desk.lease.holder, seen.driven) == (None, [])
        seen.desk.take(ben)
    assert seen.desk.lease.holder is None


def test_what_only_time_brings_is_told_on_time() -> None:
    told: list[dict[str, Any]] = []
    noted: list[str] = []

    async def run() -> None:
        clock = SteadyClock()
        desk = Desk(clock, told.append, print, noted.append)
        task = asyncio.create_task(desk.run())
        with desk.page(ANNA) as anna, desk.page(BEN) as ben:
            desk.take(anna)
            desk.take(ben)
            assert desk.lease.request is not None
            # As if nearly all of it had passed.
            desk.lease.request = replace(desk.lease.request, until=clock.now() + 0.05)
            desk.announce()
            async with asyncio.timeout(5):
                while told[-1]["holder"] != {"seat": ben.number, "name": "Ben"}:
                    await asyncio.sleep(0)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    asyncio.run(run())
    assert noted[2] == "Control passed from “Anna” to “Ben”, who had asked for it."
