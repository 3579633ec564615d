"""The figures by which sessions are compared, and what each means. docs/use/compare.md has the formulas."""

from server.features.metrics.figure import FigureMeaning


def _less(name: str, title: str, unit: str, decimals: int, meaning: str) -> FigureMeaning:
    return FigureMeaning(name=name, title=title, unit=unit, decimals=decimals, better="less", meaning=meaning)


FIGURES: tuple[FigureMeaning, ...] = (
    _less(
        "rise_time",
        "Rise time",
        "s",
        2,
        "From 10 % to 90 % of the way from the depth at the step to the set point.",
    ),
    _less(
        "settling_time",
        "Settling time",
        "s",
        2,
        "From the step until the depth stays within 5 % of the step, or the given band, about the set point.",
    ),
    _less("overshoot", "Overshoot", "%", 1, "How far the depth goes beyond the set point, of the step."),
    FigureMeaning(
        name="steady_error",
        title="Steady error",
        unit="m",
        decimals=4,
        better="zero",
        meaning="Mean of set point minus depth over the second half of the step's time.",
    ),
    _less("rmse", "RMSE", "m", 4, "Root of the mean square of set point minus depth over the range."),
    _less(
        "cycle_amplitude",
        "Limit cycle, peak to peak",
        "m",
        4,
        "Height of the lasting oscillation of the depth in the second half of the step's time.",
    ),
    FigureMeaning(
        name="cycle_period",
        title="Limit cycle, period",
        unit="s",
        decimals=2,
        better="neither",
        meaning="Time of one lasting oscillation of the depth.",
    ),
    _less(
        "fin_strokes", "Fin strokes", "", 0, "Swings of all four fins, there and back, by 0.2 rad or more."
    ),
    _less("effort", "Effort", "%", 1, "Mean size of the vertical command over the range."),
    _less(
        "frames_lost", "Frames lost", "", 0, "Frames from the board whose numbers show them to be missing."
    ),
    _less("frames_repeated", "Frames repeated", "", 0, "Reliable frames sent again by either end's request."),
    _less(
        "frames_invalid", "Frames invalid", "", 0, "Frames thrown away: garbage, wrong checksum or length."
    ),
    _less(
        "gaps", "Gaps in the recording", "", 0, "Times that samples of a topic did not reach the recording."
    ),
)
