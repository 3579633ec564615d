"""The figures by which sessions are compared. docs/use/compare.md has the formulas."""

from server.metrics.figure import FigureMeaning, describe

FIGURES: tuple[FigureMeaning, ...] = (
    describe("rise_time", "Rise time", "s", 2, "Time from 10 % to 90 % of the step in depth."),
    describe(
        "settling_time",
        "Settling time",
        "s",
        2,
        "Time until the depth stays in the band about the set point.",
    ),
    describe("overshoot", "Overshoot", "%", 1, "Largest excess over the set point, as a share of the step."),
    describe("steady_error", "Steady error", "m", 4, "Mean error in the second half of the step.", "zero"),
    describe("rmse", "RMSE", "m", 4, "Root of the mean square of set point minus depth over the range."),
    describe("cycle_amplitude", "Limit cycle, peak to peak", "m", 4, "Height of the lasting oscillation."),
    describe("cycle_period", "Limit cycle, period", "s", 2, "Period of the lasting oscillation.", "neither"),
    describe("card_latency", "Card to set point", "s", 2, "Median time from a card to its set point."),
    describe(
        "motion_latency", "Set point to motion", "s", 2, "Median time from a set point to 3 cm towards it."
    ),
    describe("fin_strokes", "Fin strokes", "", 0, "Swings of all fins, there and back, by 0.2 rad or more."),
    describe("effort", "Effort", "%", 1, "Mean size of the vertical command over the range."),
    describe("frames_lost", "Frames lost", "", 0, "Frames from the board that are missing by their numbers."),
    describe("frames_repeated", "Frames repeated", "", 0, "Reliable frames that either end sent again."),
    describe(
        "frames_invalid", "Frames invalid", "", 0, "Frames discarded: garbage, wrong checksum or length."
    ),
    describe("gaps", "Gaps in the recording", "", 0, "Times that samples of a topic missed the recording."),
)

DEEPEST = describe("deepest", "Greatest depth", "m", 2, "Greatest depth in the range.", "neither")
ALARMS = describe("alarms", "Alarms", "", 0, "Alarms that began in the range, or ended it.")
RUN_FIGURES: tuple[FigureMeaning, ...] = (
    *(meaning for meaning in FIGURES if meaning.name != "gaps"),
    DEEPEST,
    ALARMS,
)
"""Of a run that is not recorded: those of a comparison, and two of a dive."""
_SHARED = ("rmse", "cycle_amplitude", "overshoot", "settling_time", "fin_strokes", "frames_lost")
"""Figures of a comparison that a dive shows, too."""
STORY_FIGURES: tuple[FigureMeaning, ...] = (
    describe("duration", "Duration", "s", 1, "Time armed in the range.", "neither"),
    DEEPEST,
    *(meaning for name in _SHARED for meaning in FIGURES if meaning.name == name),
    ALARMS,
)
