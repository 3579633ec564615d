"""Definitions of a step response's figures; they load no NumPy."""

from server.metrics.figure import FigureMeaning, describe

NEAR = 0.02
"""m; the band of one settling time, whatever the step."""
NEAR_DEGREES = 2.0


def is_angle(loop: str) -> bool:
    """Return True if the loop's unit is rad, shown in degrees; else it is m."""
    return loop != "depth"


def near(loop: str) -> float:
    """Return the band of the second settling time, m or degrees."""
    return NEAR_DEGREES if is_angle(loop) else NEAR


def meanings(loop: str) -> list[FigureMeaning]:
    """Return the figures of a step response of this loop, from the step on, in their order."""
    unit, decimals = ("°", 2) if is_angle(loop) else ("m", 3)
    band = f"{NEAR_DEGREES:g}°" if is_angle(loop) else f"{100 * NEAR:g} cm"
    return [
        describe("rise_time", "Rise time", "s", 2, "Time from 10 % to 90 % of the step."),
        describe(
            "overshoot", "Overshoot", "%", 1, "Largest excess over the set point, as a share of the step."
        ),
        describe(
            "settling_near", f"Settling to ±{band}", "s", 2, f"Time until the error stays within {band}."
        ),
        describe(
            "settling_share", "Settling to ±5 %", "s", 2, "Time until the error stays within 5 % of the step."
        ),
        describe(
            "steady_error",
            "Steady error",
            unit,
            decimals,
            "Mean error in the second half of the step.",
            "zero",
        ),
        describe(
            "steady_swing",
            "Steady peak to peak",
            unit,
            decimals,
            "Highest minus lowest value in the second half.",
        ),
        describe("rmse", "RMSE", unit, decimals, "Root of the mean square of set point minus value."),
        describe("iae", "IAE", f"{unit} s", decimals, "Integral of the size of set point minus value."),
        describe("effort", "Effort", "%", 1, "Mean size of the command."),
        describe(
            "travel", "Command travel", "", 1, "Sum of the command's changes; 1 is from rest to full command."
        ),
        describe(
            "fin_strokes", "Fin strokes", "", 0, "Swings of all fins, there and back, by 0.2 rad or more."
        ),
    ]
