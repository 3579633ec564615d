"""Rules that compute the gains of a PID from ultimate gain and period.

Each rule gives gain Kp, integral time Ti and derivative time Td of u = Kp (e + ∫e dt / Ti + Td de/dt); the
robot's PID is the parallel form: kp = Kp, ki = Kp / Ti, kd = Kp Td.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, sqrt

from robot_runtime.contract.limits import LoopName
from server.features.tuning.schemas import MeasuredLimitCycle, Proposal

DIGITS = 4
"""Significant digits of proposed gains: more than the limit cycle is known to, few enough to be read."""


@dataclass(frozen=True, slots=True)
class Rule:
    """Kp as a share of the ultimate gain; Ti and Td as shares of the ultimate period."""

    name: str
    title: str
    gain: float
    integral: float
    derivative: float
    source: str
    known_for: str
    integrating: bool = False
    """True if it holds only for a value that drifts under a constant command, as depth and heading do."""

    def gains(self, ultimate_gain: float, ultimate_period: float) -> dict[str, float]:
        """Return kp, ki and kd."""
        kp = self.gain * ultimate_gain
        return {
            "kp": kp,
            "ki": kp / (self.integral * ultimate_period),
            "kd": kp * self.derivative * ultimate_period,
        }


RULES = (
    Rule(
        "ziegler_nichols",
        "Ziegler–Nichols",
        *(0.6, 0.5, 0.125),
        source="Ziegler and Nichols, Transactions of the ASME 64, 1942",
        known_for="Fast, with much overshoot: each swing a quarter of the one before.",
    ),
    Rule(
        "some_overshoot",
        "Some overshoot",
        *(1 / 3, 0.5, 1 / 3),
        source="Seborg, Edgar and Mellichamp, Process Dynamics and Control, 1989",
        known_for="Ziegler–Nichols with less gain and more damping.",
    ),
    Rule(
        "no_overshoot",
        "No overshoot",
        *(0.2, 0.5, 1 / 3),
        source="Seborg, Edgar and Mellichamp, Process Dynamics and Control, 1989",
        known_for="The same, gentler still. On an integrating process its quick integral overshoots even so.",
    ),
    Rule(
        "tyreus_luyben",
        "Tyreus–Luyben",
        *(1 / 2.2, 2.2, 1 / 6.3),
        source="Tyreus and Luyben, Industrial & Engineering Chemistry Research 31, 1992",
        known_for="Calm, for integrating processes with a dead time: little integral, little overshoot.",
    ),
    Rule(
        "amigo",
        "AMIGO",
        *(0.3, 0.6, 0.15),
        source="Åström and Hägglund, Advanced PID Control, 2006, chapter 7, with gain ratio 0",
        known_for="Robust: its maximum sensitivity is 1.4 for most processes.",
        integrating=True,
    ),
)


def ultimate_gain(amplitude: float, swing: float, hysteresis: float) -> float:
    """Return the ultimate gain from a relay of ±`amplitude` with `hysteresis` and a limit cycle of ±`swing`.

    Åström and Hägglund, Automatica 20, 1984: 4 d / (π √(a² - ε²)), by the relay's describing function. Raise
    ValueError where the swing is no larger than the hysteresis.
    """
    if swing <= hysteresis:
        raise ValueError(f"a swing of {swing:g} does not go beyond the hysteresis, {hysteresis:g}")
    return 4 * amplitude / (pi * sqrt(swing**2 - hysteresis**2))


def propose(
    loop: LoopName, cycle: MeasuredLimitCycle, limits: Mapping[str, tuple[float, float]]
) -> list[Proposal]:
    """Return the gains by each rule for this loop. `limits` are those of each gain, by name."""
    proposals = []
    for rule in RULES:
        # Pitch and roll have the hull's righting moment: a constant command holds them at an angle.
        if rule.integrating and loop in ("pitch", "roll"):
            continue
        computed = rule.gains(cycle.ultimate_gain, cycle.period)
        gains = {name: float(f"{value:.{DIGITS}g}") for name, value in computed.items()}
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
