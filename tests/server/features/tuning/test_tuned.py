"""Tuning on the simulated robot from end to end: a relay, gains by a rule, and a step with them."""

from server.features.tuning.rules import propose
from tests.runtime.control.flight import Flight
from tests.server.features.tuning.rig import TuningRig


def test_gains_from_a_relay_hold_the_depth() -> None:
    with Flight() as flight:
        rig = TuningRig(flight)
        cycle = rig.relay(0.5, cycles=3)
        gains = {proposal.rule: proposal.gains for proposal in propose("depth", cycle, {})}["tyreus_luyben"]
        rig.use("pid", gains)
        tuned = rig.step(0.4, 0.7, 12.0)
        rig.use("bang_bang", {})
        bang_bang = rig.step(0.4, 0.7, 12.0)
    assert tuned["overshoot"] is not None
    assert tuned["overshoot"] < 30.0
    for name, share in {"steady_swing": 0.7, "effort": 0.5}.items():
        better, worse = tuned[name], bang_bang[name]
        assert better is not None
        assert worse is not None
        assert better < share * worse, (name, better, worse)
