"""The whole way on the simulated robot: a relay, gains by a rule, and a step with them."""

from server.tuning.proposals import propose
from tests.runtime.control.flight import Flight
from tests.server.tuning.rig import Rig


def test_gains_from_a_relay_hold_the_depth() -> None:
    with Flight() as flight:
        rig = Rig(flight)
        cycle = rig.relay(0.5, cycles=3)
        assert cycle.remarks == []
        gains = {one.rule: one.gains for one in propose("depth", cycle, {})}["tyreus_luyben"]
        rig.use("pid", gains)
        figures = rig.step(0.4, 0.7, 15.0)
    assert figures["steady_swing"] is not None
    assert figures["overshoot"] is not None
    # The bang-bang controller never stays within 2 cm.
    assert figures["settling_near"] is not None
    assert figures["steady_swing"] < 0.03
    assert figures["overshoot"] < 35.0
