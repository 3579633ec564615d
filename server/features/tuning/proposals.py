"""Gains of a PID that the rules propose for what a relay experiment has measured."""

from collections.abc import Mapping

from robot_runtime.contract.limits import LoopName
from server.features.tuning.rules import RULES
from server.features.tuning.schemas import MeasuredLimitCycle, Proposal

DIGITS = 4
"""Significant digits: more than the limit cycle is known to, few enough to be read."""


def propose(
    loop: LoopName, cycle: MeasuredLimitCycle, limits: Mapping[str, tuple[float, float]]
) -> list[Proposal]:
    """By each rule that holds for the loop. `limits` are least and most of each gain, by name."""
    proposals = []
    for rule in RULES:
        # Pitch and roll have the hull's righting moment: a constant command holds them at an angle.
        if rule.integrating and loop in ("pitch", "roll"):
            continue
        found = rule.gains(cycle.ultimate_gain, cycle.period)
        gains = {name: float(f"{value:.{DIGITS}g}") for name, value in found.items()}
        proposals.append(
            Proposal(
                rule=rule.name,
                title=rule.title,
                source=rule.source,
                known_for=rule.known_for,
                gains=gains,
                problem=_problem(gains, limits),
            )
        )
    return proposals


def _problem(gains: Mapping[str, float], limits: Mapping[str, tuple[float, float]]) -> str:
    wrong = [
        f"{name} may be {limits[name][0]:g} to {limits[name][1]:g}"
        for name, value in gains.items()
        if name in limits and not limits[name][0] <= value <= limits[name][1]
    ]
    return f"{'; '.join(wrong)}." if wrong else ""
