import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.errors import Refused
from server.features.lease.lease import ANSWER_SECONDS, REFUSED_SECONDS, Lease, NotInControl, Waiting

ANNA, BEN, CLEO = 1, 2, 3


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(50.0)


@pytest.fixture
def lease(clock: SimulatedClock) -> Lease:
    """Anna has it."""
    lease = Lease(clock, 7, lambda *_: None)
    lease.take(ANNA)
    return lease


def test_free_control_is_taken_at_once_and_again_without_a_change(clock: SimulatedClock) -> None:
    lease = Lease(clock, 7, lambda *_: None)
    assert (lease.holder, lease.epoch) == (None, 7)
    lease.take(ANNA)
    lease.take(ANNA)
    assert (lease.holder, lease.epoch, lease.request) == (ANNA, 8, None)


def test_held_control_passes_when_the_holder_has_been_silent_for_ten_seconds(
    lease: Lease, clock: SimulatedClock
) -> None:
    lease.take(BEN)
    assert lease.request == Waiting(BEN, 60.0)
    assert lease.next_moment() == 60.0
    clock.forward(ANSWER_SECONDS - 0.001)
    lease.settle()
    assert (lease.holder, lease.epoch) == (ANNA, 8)
    clock.forward(0.001)
    lease.settle()
    assert (lease.holder, lease.epoch, lease.request) == (BEN, 9, None)


def test_asking_again_does_not_begin_the_wait_anew(lease: Lease, clock: SimulatedClock) -> None:
    lease.take(BEN)
    clock.forward(6)
    lease.take(BEN)
    assert lease.request == Waiting(BEN, 60.0)


def test_there_is_one_request_at_a_time(lease: Lease) -> None:
    lease.take(BEN)
    with pytest.raises(Refused, match="already"):
        lease.take(CLEO)
    assert lease.request == Waiting(BEN, 60.0)


def test_who_was_refused_waits_before_asking_again_and_others_need_not(
    lease: Lease, clock: SimulatedClock
) -> None:
    lease.take(BEN)
    lease.refuse(ANNA)
    assert (lease.holder, lease.epoch, lease.request) == (ANNA, 8, None)
    assert lease.refused == Waiting(BEN, 60.0)
    clock.forward(4)
    with pytest.raises(Refused, match="in 6 s"):
        lease.take(BEN)
    lease.take(CLEO)
    lease.refuse(ANNA)
    assert lease.refused == Waiting(CLEO, 64.0)
    clock.forward(REFUSED_SECONDS - 4)
    lease.take(BEN)
    assert lease.request == Waiting(BEN, 70.0)


def test_whom_the_last_holder_refused_may_ask_the_next_one_at_once(lease: Lease) -> None:
    lease.take(BEN)
    lease.refuse(ANNA)
    lease.hand_over(ANNA, CLEO)
    lease.take(BEN)
    assert lease.request is not None


def test_a_refusal_that_comes_too_late_is_none(lease: Lease, clock: SimulatedClock) -> None:
    lease.take(BEN)
    clock.forward(ANSWER_SECONDS)
    with pytest.raises(NotInControl):
        lease.refuse(ANNA)
    assert lease.holder == BEN


def test_only_the_holder_refuses_and_hands_over(lease: Lease) -> None:
    lease.take(BEN)
    for seat in (BEN, CLEO):
        with pytest.raises(NotInControl):
            lease.refuse(seat)
        with pytest.raises(NotInControl):
            lease.hand_over(seat, seat)
    assert (lease.holder, lease.epoch, lease.request) == (ANNA, 8, Waiting(BEN, 60.0))


def test_nothing_is_refused_where_nobody_asks(lease: Lease) -> None:
    with pytest.raises(Refused, match="Nobody asks"):
        lease.refuse(ANNA)


def test_handed_over_it_is_another_s_at_once_and_who_asked_asks_anew(lease: Lease) -> None:
    lease.take(BEN)
    lease.hand_over(ANNA, CLEO)
    assert (lease.holder, lease.epoch, lease.request) == (CLEO, 9, None)
    lease.hand_over(CLEO, CLEO)
    assert lease.epoch == 9


def test_what_is_released_is_free_or_the_one_s_who_asked(lease: Lease) -> None:
    lease.take(BEN)
    lease.release(ANNA)
    assert (lease.holder, lease.epoch, lease.request) == (BEN, 9, None)
    lease.release(ANNA)
    assert lease.holder == BEN
    lease.release(BEN)
    assert (lease.holder, lease.epoch) == (None, 10)


def test_who_asked_may_think_better_of_it(lease: Lease, clock: SimulatedClock) -> None:
    lease.take(BEN)
    lease.release(BEN)
    assert lease.request is None
    clock.forward(ANSWER_SECONDS)
    lease.settle()
    assert (lease.holder, lease.epoch) == (ANNA, 8)


def test_a_seat_that_is_no_more_holds_nothing_and_asks_for_nothing(lease: Lease) -> None:
    lease.take(BEN)
    lease.refuse(ANNA)
    lease.forget(BEN)
    assert lease.refused is None
    lease.take(CLEO)
    lease.forget(CLEO)
    assert lease.request is None
    lease.forget(ANNA)
    assert lease.holder is None
