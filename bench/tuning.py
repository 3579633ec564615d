"""Results of relay tuning: the depth's limit cycle, and a step with the gains of each rule.

In simulated time, with the robot's own firmware on this computer. `python -m bench.tuning` prints both.
"""

from collections.abc import Mapping

from robot_runtime.control.controllers import CONTROLLERS
from server.features.tuning.rules import propose
from server.features.tuning.schemas import MeasuredLimitCycle
from tests.runtime.control.flight import Flight
from tests.server.features.tuning.rig import TuningRig

BOARD = "host"
AMPLITUDES = (0.3, 0.5, 0.8)
AMPLITUDE = 0.5
FROM, TO, SECONDS = 0.4, 0.8, 25.0
RULE = "tyreus_luyben"
SHOWN = ("overshoot", "settling_near", "rise_time", "steady_swing", "steady_error", "rmse", "fin_strokes")


def measure() -> dict[str, float]:
    """Return figures of the depth's PID by one rule, from a relay experiment on the emulated robot."""
    cycle = _relay(AMPLITUDE)
    gains = {proposal.rule: proposal.gains for proposal in propose("depth", cycle, {})}[RULE]
    figures = _step("pid", gains)
    return {
        "tuning.ultimate_gain": cycle.ultimate_gain,
        "tuning.ultimate_period_s": cycle.period,
        "tuning.overshoot_percent": figures["overshoot"] or 0.0,
        "tuning.settling_2cm_s": figures["settling_near"] or float("inf"),
        "tuning.steady_swing_cm": 100 * (figures["steady_swing"] or 0.0),
    }


def main() -> None:
    """Print both tables."""
    cycles = {amplitude: _relay(amplitude) for amplitude in AMPLITUDES}
    for amplitude, cycle in cycles.items():
        print(
            f"| ±{100 * amplitude:.0f} % | {cycle.period:.2f} s | ±{100 * cycle.swing:.1f} cm | "
            f"{100 * cycle.bias:.0f} % | {100 * cycle.asymmetry:.0f} % | {cycle.ultimate_gain:.1f} 1/m |"
        )
    for kind in CONTROLLERS["depth"]:
        _print_row(kind.title, kind.name, {})
    for proposal in propose("depth", cycles[AMPLITUDE], {}):
        _print_row(f"PID by {proposal.title}", "pid", proposal.gains)


def _relay(amplitude: float) -> MeasuredLimitCycle:
    with Flight(BOARD) as flight:
        return TuningRig(flight).relay(amplitude)


def _step(controller: str, gains: Mapping[str, float]) -> dict[str, float | None]:
    with Flight(BOARD) as flight:
        rig = TuningRig(flight)
        rig.use(controller, dict(gains))
        return rig.step(FROM, TO, SECONDS)


def _print_row(title: str, controller: str, gains: Mapping[str, float]) -> None:
    figures = _step(controller, gains)
    shown = ["–" if (value := figures[name]) is None else f"{value:.3g}" for name in SHOWN]
    text = ", ".join(f"{name} {value:.3g}" for name, value in gains.items())
    print(f"| {title} | {text} | {' | '.join(shown)} |", flush=True)


if __name__ == "__main__":
    main()
