from robot_runtime.clock import SimulatedClock
from robot_runtime.control.pilot import EPOCHS_AHEAD, Pilot
from server.driving.lease import Change, Lease

ANNA, BEN = 1, 2


class Recorded:
    """A lease and its reported changes."""

    def __init__(self) -> None:
        self.changes: list[tuple[Change, int | None, int | None]] = []
        self.lease = Lease(SimulatedClock(0.007), lambda *change: self.changes.append(change))


def test_free_control_is_taken_at_once_and_again_without_a_change() -> None:
    recorded = Recorded()
    lease = recorded.lease
    assert (lease.holder, lease.epoch) == (None, 7)
    lease.take(ANNA)
    lease.take(ANNA)
    assert (lease.holder, lease.epoch) == (ANNA, 8)
    assert recorded.changes == [("taken", ANNA, None)]


def test_held_control_is_taken_over_in_a_new_epoch() -> None:
    recorded = Recorded()
    recorded.lease.take(ANNA)
    recorded.lease.take(BEN)
    assert (recorded.lease.holder, recorded.lease.epoch) == (BEN, 9)
    assert recorded.changes[1:] == [("taken over", BEN, ANNA)]


def test_only_the_holder_releases_control() -> None:
    recorded = Recorded()
    lease = recorded.lease
    lease.take(ANNA)
    lease.release(BEN)
    lease.forget(BEN)
    assert (lease.holder, lease.epoch) == (ANNA, 8)
    lease.release(ANNA)
    assert (lease.holder, lease.epoch) == (None, 9)
    lease.release(ANNA)
    lease.take(BEN)
    lease.forget(BEN)
    assert (lease.holder, lease.epoch) == (None, 11)
    assert recorded.changes[1:] == [("released", None, ANNA), ("taken", BEN, None), ("left", None, BEN)]


def test_an_epoch_is_above_all_that_the_runtime_has_accepted_until_now() -> None:
    clock = SimulatedClock(5.0)
    lease, pilot = Lease(clock, lambda *_: None), Pilot(clock)
    pilot.change_lease(5000 + EPOCHS_AHEAD)
    clock.forward(EPOCHS_AHEAD / 1000 + 0.001)
    lease.take(ANNA)
    pilot.change_lease(lease.epoch)
    assert pilot.lease == lease.epoch
