"""Definitions of a step response's figures, without the code that computes them."""

from server.features.metrics.figure import FigureMeaning

NEAR = 0.02
"""m, and 2 for angles in degrees: the band of one settling time, whatever the step."""
NEAR_DEGREES = 2.0


def is_angle(loop: str) -> bool:
    """True where the loop's unit is rad, shown in degrees; else it is m."""
    return loop != "depth"


def near(loop: str) -> float:
    """The band of the second settling time, m or degrees."""
    return NEAR_DEGREES if is_angle(loop) else NEAR


def meanings(loop: str) -> list[FigureMeaning]:
    """The figures of a step response of this loop, in their order."""
    unit, decimals = ("°", 2) if is_angle(loop) else ("m", 3)
    band = f"{NEAR_DEGREES:g}°" if is_angle(loop) else f"{100 * NEAR:g} cm"
    return [
        _less(
            "rise_time",
            "Rise time",
            "s",
            2,
            "From 10 % to 90 % of the way from the value at the step to the set point.",
        ),
        _less(
            "overshoot",
            "Overshoot",
            "%",
            1,
            "How far the value goes beyond the set point, as a share of the step.",
        ),
        _less(
            "settling_near",
            f"Settling to ±{band}",
            "s",
            2,
            f"From the step until the value stays within {band} of the set point.",
        ),
        _less(
            "settling_share",
            "Settling to ±5 %",
            "s",
            2,
            "From the step until the value stays within 5 % of the step about the set point.",
        ),
        FigureMeaning(
            name="steady_error",
            title="Steady error",
            unit=unit,
            decimals=decimals,
            better="zero",
            meaning="Mean of set point minus value over the second half of the time after the step.",
        ),
        _less(
            "steady_swing",
            "Steady peak to peak",
            unit,
            decimals,
            "Highest minus lowest value in the second half of the time after the step.",
        ),
        _less(
            "rmse",
            "RMSE",
            unit,
            decimals,
            "Root of the mean square of set point minus value from the step on.",
        ),
        _less(
            "iae",
            "IAE",
            f"{unit} s",
            decimals,
            "Integral of the size of set point minus value from the step on.",
        ),
        _less("effort", "Effort", "%", 1, "Mean size of the command from the step on."),
        _less(
            "travel",
            "Command travel",
            "",
            1,
            "How far the command went there and back from the step on; from rest to the most is 1.",
        ),
        _less(
            "fin_strokes",
            "Fin strokes",
            "",
            0,
            "Swings of all four fins, there and back, by 0.2 rad or more, from the step on.",
        ),
    ]


def _less(name: str, title: str, unit: str, decimals: int, meaning: str) -> FigureMeaning:
    return FigureMeaning(name=name, title=title, unit=unit, decimals=decimals, better="less", meaning=meaning)
