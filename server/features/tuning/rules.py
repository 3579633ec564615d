"""From ultimate gain and period to gains of a PID, by named rules.

Each rule gives gain Kp, integral time Ti and derivative time Td of u = Kp (e + ∫e dt / Ti + Td de/dt); the
robot's PID is the parallel form: kp = Kp, ki = Kp / Ti, kd = Kp Td.
"""

from dataclasses import dataclass
from math import pi, sqrt


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
    """Whether it holds only where the value runs away under a constant command, as depth and heading do."""

    def gains(self, ultimate_gain: float, ultimate_period: float) -> dict[str, float]:
        """kp, ki and kd."""
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
    """Of a relay of ±`amplitude` that switches `hysteresis` late, whose limit cycle swings ±`swing`.

    Åström and Hägglund, Automatica 20, 1984: 4 d / (π √(a² - ε²)), by the relay's describing function. Raises
    ValueError where the swing is no larger than the hysteresis.
    """
    if swing <= hysteresis:
        raise ValueError(f"a swing of {swing:g} does not go beyond the hysteresis, {hysteresis:g}")
    return 4 * amplitude / (pi * sqrt(swing**2 - hysteresis**2))
