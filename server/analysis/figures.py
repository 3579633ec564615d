"""Figures of one session over a range of its time."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robot_runtime.contract.topics import LINK, MOTOR
from server.analysis.definitions import FIGURES
from server.analysis.history import read_gaps, set_point_steps
from server.analysis.moments import ControlHistory, Span
from server.analysis.samples import Samples, read_topic
from server.library.content import Recording
from server.metrics.card_response import card_latencies, motion_latency
from server.metrics.figure import Figure, FigureMark
from server.metrics.limit_cycle import LimitCycle, find_limit_cycle
from server.metrics.series import Series, effort, rms
from server.metrics.step_response import StepResponse, measure_step
from server.metrics.strokes import count_strokes
from server.platform.store import Reader

Steps = Sequence[tuple[float, float]]
"""Moments (s) at which the set point changes, each with the new one (m)."""
MEASURED, SET_POINT, OUTPUT = "depth.depth", "control.set_point", "control.output"
HEIGHT_LEAST = 0.05
"""m; smallest step that is evaluated."""
LATE_MOST = 0.5
"""s by which a recording may begin after the evaluated step, as one that begins at arming does."""
_FINS = tuple(f"angle_{fin}" for fin in range(4))
_LINK = {
    "frames_lost": "frames_missed",
    "frames_repeated": "frames_repeated",
    "frames_invalid": "frames_invalid",
}
NOTHING_THERE = "The recording has no depth and set point in this range."
NEVER_ARMED = "The robot was never armed in this session."


@dataclass(frozen=True, slots=True)
class EvaluationRange:
    """The time range of figures.

    `anchor` is the moment (s) of the evaluated step; without it the first one in the range.
    """

    spans: tuple[Span, ...]
    anchor: float | None = None

    def mask(self, times: np.ndarray) -> np.ndarray:
        """Return a mask of the times (s) in the range."""
        inside = np.zeros(times.size, bool)
        for span in self.spans:
            first, last = np.searchsorted(times, [span.start, span.end], "left")
            inside[first:last] = True
        return inside


def measure(
    recording: Recording,
    samples: Samples,
    history: ControlHistory,
    evaluated: EvaluationRange,
    band: float | None = None,
) -> dict[str, Figure]:
    """Return the FIGURES of depth, set point and command; `band` is that of the settling time, m.

    Raise StoreError, RecordingError.
    """
    if not evaluated.spans:
        return {}
    return measure_series(samples.read(recording, [MEASURED, SET_POINT, OUTPUT]), history, evaluated, band)


def measure_series(
    series: Mapping[str, Series],
    history: ControlHistory,
    evaluated: EvaluationRange,
    band: float | None = None,
) -> dict[str, Figure]:
    """Return the same of signals that are read already, by their names; a missing one has no figures."""
    figures: dict[str, Figure] = {}
    depth, set_point = series.get(MEASURED), series.get(SET_POINT)
    if depth is not None and set_point is not None:
        steps = set_point_steps(set_point, history.armed)
        figures |= _depth_figures(depth, set_point, steps, history, evaluated, band)
        figures |= _latencies(depth, set_point, steps, history, evaluated)
    if (output := series.get(OUTPUT)) is not None:
        figures["effort"] = _effort(output, evaluated)
    return figures


def count(store: Reader, recording: Recording, spans: Sequence[Span]) -> dict[str, Figure]:
    """Return the counted FIGURES: strokes, losses, gaps; over the whole session without `spans`.

    Raise StoreError, RecordingError.
    """
    whole = spans or (Span(0.0, recording.row.duration),)
    return count_samples(recording, spans) | {"gaps": _gaps(store, recording, whole)}


def count_samples(recording: Recording, spans: Sequence[Span]) -> dict[str, Figure]:
    """Return the same without the gaps: what follows from the samples alone. Raise as `count`."""
    figures = {"fin_strokes": count_fin_strokes(recording, spans)} if spans else {}
    whole = spans or (Span(0.0, recording.row.duration),)
    return figures | count_losses(read_losses(recording), whole)


def complete(measured: Mapping[str, Figure], why: str) -> dict[str, Figure]:
    """Return all FIGURES in their order; `why` is the reason for missing ones."""
    missing = Figure(value=None, words=why)
    return {meaning.name: measured.get(meaning.name, missing) for meaning in FIGURES}


def _depth_figures(
    depth: Series,
    set_point: Series,
    steps: Steps,
    history: ControlHistory,
    evaluated: EvaluationRange,
    band: float | None,
) -> dict[str, Figure]:
    response = _step(depth, set_point, steps, history, evaluated, band)
    figures = _step_figures(response)
    steady = (
        Span((response.begin + response.end) / 2, response.end)
        if response is not None
        else evaluated.spans[0]
    )
    # The next set point may be in force at the end itself.
    part = depth.within(steady.start, float(np.nextafter(steady.end, steady.start)))
    if part.times.size:
        errors = _held(set_point, part.times) - part.values
        mean = float(errors.mean())
        level = float(part.values.mean())
        mark = FigureMark(
            start=steady.start, end=steady.end, low=min(level, level + mean), high=max(level, level + mean)
        )
        figures["steady_error"] = Figure(value=mean, mark=mark)
        figures |= _cycle_figures(find_limit_cycle(Series(part.times, errors)), steady, part)
    inside = evaluated.mask(depth.times)
    if inside.any():
        errors = _held(set_point, depth.times[inside]) - depth.values[inside]
        figures["rmse"] = Figure(
            value=rms(errors), mark=FigureMark(start=evaluated.spans[0].start, end=evaluated.spans[-1].end)
        )
    return figures


def _step(
    depth: Series,
    set_point: Series,
    steps: Steps,
    history: ControlHistory,
    evaluated: EvaluationRange,
    band: float | None,
) -> StepResponse | None:
    """Return the response to the first high enough step in the range, or to the step at the anchor."""
    changes = [time for time, _ in steps]
    armings = [span.start for span in history.armed]
    for span in evaluated.spans:
        for begin in sorted({*armings, *changes}):
            meant = evaluated.anchor is None or abs(begin - evaluated.anchor) < 1e-6
            recorded = begin >= depth.times[0] - LATE_MOST
            if not (meant and recorded and span.start <= begin < span.end):
                continue
            ends = [span.end, *(change for change in (*changes, *_ends(history)) if change > begin)]
            response = measure_step(depth, begin, min(ends), _value_at(set_point, begin), band)
            if response is not None and abs(response.final_value - response.start_value) >= HEIGHT_LEAST:
                return response
    return None


def _ends(history: ControlHistory) -> Iterable[float]:
    return (span.end for span in history.armed)


def _value_at(set_point: Series, time: float) -> float:
    """Return the set point of the first tick at or after `time`."""
    at = min(int(np.searchsorted(set_point.times, time, "left")), set_point.times.size - 1)
    return float(set_point.values[at])


def _held(set_point: Series, times: np.ndarray) -> np.ndarray:
    """Return the set point at these times: each value holds until the next."""
    at = np.searchsorted(set_point.times, times, "right") - 1
    return set_point.values[np.maximum(at, 0)]


def _step_figures(response: StepResponse | None) -> dict[str, Figure]:
    if response is None:
        none = Figure(value=None, words="There is no step of the set point by 5 cm or more in this range.")
        return dict.fromkeys(("rise_time", "settling_time", "overshoot"), none)
    begin, final, band = response.begin, response.final_value, response.band
    height = final - response.start_value
    text = f"Step from {response.start_value:.2f} m to {final:.2f} m."
    rise = Figure(value=None, words=f"{text} The depth never came to 90 % of it.")
    if response.rise_start is not None and response.rise_end is not None:
        levels = sorted(response.start_value + share * height for share in (0.1, 0.9))
        mark = FigureMark(start=response.rise_start, end=response.rise_end, low=levels[0], high=levels[1])
        rise = Figure(value=response.rise_time, words=text, mark=mark)
    settling = Figure(
        value=response.settling_time,
        words=f"{text} Band: {band * 100:.1f} cm either way."
        if response.settled is not None
        else f"{text} The depth did not stay within {band * 100:.1f} cm until the next step.",
        mark=FigureMark(
            start=begin, end=response.settled or response.end, low=final - band, high=final + band
        ),
    )
    over = Figure(value=100 * response.overshoot, words=text)
    if response.peak is not None and response.peak_time is not None:
        low, high = sorted((final, response.peak))
        over.mark = FigureMark(start=begin, end=response.peak_time, low=low, high=high)
    return {"rise_time": rise, "settling_time": settling, "overshoot": over}


def _latencies(
    depth: Series, set_point: Series, steps: Steps, history: ControlHistory, evaluated: EvaluationRange
) -> dict[str, Figure]:
    """Return the median latencies of cards and set points; steps below HEIGHT_LEAST do not count."""
    cards: list[float | None] = []
    motions: list[float | None] = []
    for span in evaluated.spans:
        inside = [(time, value) for time, value in steps if span.start <= time < span.end]
        shown = [change.time for change in history.cards if span.start <= change.time < span.end]
        cards += card_latencies(shown, [time for time, _ in inside], span.end)
        for (begin, value), end in zip(inside, [*(time for time, _ in inside), span.end][1:], strict=True):
            if abs(value - _held(set_point, np.array([begin - 1e-6]))[0]) >= HEIGHT_LEAST:
                motions.append(motion_latency(depth, begin, end, value))
    return {
        "card_latency": _median(cards, "cards changed the set point before the next one"),
        "motion_latency": _median(motions, "set points were followed by 3 cm before the next one"),
    }


def _median(latencies: Sequence[float | None], what: str) -> Figure:
    known = [latency for latency in latencies if latency is not None]
    if not latencies:
        return Figure(value=None, words="There are none in this range.")
    return Figure(
        value=float(np.median(known)) if known else None, words=f"{len(known)} of {len(latencies)} {what}."
    )


def _cycle_figures(cycle: LimitCycle | None, steady: Span, part: Series) -> dict[str, Figure]:
    if cycle is None:
        none = Figure(value=None, words="The depth has no lasting oscillation.")
        return {"cycle_amplitude": none, "cycle_period": none}
    middle = float(np.median([part.values.min(), part.values.max()]))
    low, high = middle - cycle.amplitude / 2, middle + cycle.amplitude / 2
    height = FigureMark(start=steady.start, end=steady.end, low=low, high=high)
    period = FigureMark(start=steady.start, end=steady.start + cycle.period, low=low, high=high)
    return {
        "cycle_amplitude": Figure(value=cycle.amplitude, mark=height),
        "cycle_period": Figure(value=cycle.period, mark=period),
    }


def _effort(output: Series, evaluated: EvaluationRange) -> Figure:
    inside = evaluated.mask(output.times)
    if not inside.any():
        return Figure(value=None, words="There is no command in this range.")
    return Figure(value=100 * effort(output.values[inside]))


def count_fin_strokes(recording: Recording, spans: Sequence[Span]) -> Figure:
    """Return the strokes of all fins. Raise StoreError, RecordingError."""
    origin = recording.row.started_steady
    strokes, seen = 0.0, False
    for span in spans:
        if MOTOR.name not in recording.topics:
            break
        _, angles = recording.columns(MOTOR.name, _FINS, span.start + origin, span.end + origin)
        seen = seen or bool(angles[_FINS[0]].size)
        strokes += sum(count_strokes(angle) for angle in angles.values())
    if not seen:
        return Figure(value=None, words="The recording has no fin angles in this range.")
    return Figure(value=strokes)


def read_losses(recording: Recording) -> dict[str, Series]:
    """Return the link's counters, by their columns. Raise StoreError, RecordingError."""
    return read_topic(recording, LINK.name, _LINK.values())


def count_losses(columns: Mapping[str, Series], spans: Sequence[Span]) -> dict[str, Figure]:
    """Return what these counters of the link counted in the spans."""
    figures: dict[str, Figure] = {}
    for name, column in _LINK.items():
        if column not in columns:
            figures[name] = Figure(value=None, words="The recording has no statistics of the link.")
            continue
        series = columns[column]
        counted = 0.0
        for span in spans:
            # The count before the range is the first value; a reopened port counts from 0.
            first = max(int(np.searchsorted(series.times, span.start, "right")) - 1, 0)
            last = int(np.searchsorted(series.times, span.end, "right"))
            steps = np.diff(series.values[first:last])
            counted += float(np.where(steps >= 0, steps, series.values[first:last][1:]).sum())
        figures[name] = Figure(value=counted)
    return figures


def _gaps(store: Reader, recording: Recording, spans: Sequence[Span]) -> Figure:
    origin = recording.row.started_steady
    gaps = [
        gap
        for gap in read_gaps(store, recording)
        if any(span.start <= gap.time - origin <= span.end for span in spans)
    ]
    missed: dict[str, int] = {}
    for gap in gaps:
        missed[gap.topic] = missed.get(gap.topic, 0) + gap.missed
    text = ", ".join(f"{count} of {topic}" for topic, count in missed.items())
    return Figure(value=len(gaps), words=f"Missing samples: {text}." if gaps else "")
