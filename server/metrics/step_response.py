"""Figures of a step response: rise time, settling time, overshoot.

Definitions as in Åström and Murray, Feedback Systems, 2nd edition, 2021 (step response), and Åström and
Hägglund, Advanced PID Control, 2006, with the set point as the final value, since the robot should
reach it. With y0 the value at the step, r the set point and h = r - y0:

    rise time       from the first y = y0 + 0.1 h to the first y = y0 + 0.9 h
    settling time   from the step until |r - y| is at most the band for the last time, and stays so
    overshoot       the most that y goes beyond r, as a share of |h|

The band is a share of |h|, or a number in the signal's unit.
"""

from dataclasses import dataclass

import numpy as np

from server.metrics.series import Series

BAND = 0.05
STAY = 0.2
"""Share of the time until the next step, at its end, for which the value must stay in the band."""


@dataclass(frozen=True, slots=True)
class StepResponse:
    """Times in s since the session's start; None if the value was never reached."""

    begin: float
    end: float
    """Time of the next step, or of the record's end."""
    start_value: float
    final_value: float
    band: float
    rise_start: float | None
    rise_end: float | None
    settled: float | None
    overshoot: float
    """Share of the step, 0 where there is none."""
    peak_time: float | None
    peak: float | None

    @property
    def rise_time(self) -> float | None:
        """The rise time, s."""
        if self.rise_start is None or self.rise_end is None:
            return None
        return self.rise_end - self.rise_start

    @property
    def settling_time(self) -> float | None:
        """The settling time, s."""
        return None if self.settled is None else self.settled - self.begin


def measure_step(
    measured: Series, begin: float, end: float, final_value: float, band: float | None = None
) -> StepResponse | None:
    """Return the response between these times (s) to a step to `final_value` at `begin`.

    `band` is in the signal's unit, 5 % of the step without. None where there are no two samples, or where the
    value is at the set point from the beginning on.
    """
    part = measured.within(begin, end)
    times, values = part.times, part.values
    if times.size < 2:
        return None
    start_value = float(np.interp(begin, measured.times, measured.values))
    height = final_value - start_value
    if abs(height) < 1e-9:
        return None
    share = (values - start_value) / height
    width = abs(height) * BAND if band is None else band
    peak = int(np.argmax(share))
    over = max(0.0, float(share[peak]) - 1.0)
    return StepResponse(
        begin=begin,
        end=end,
        start_value=start_value,
        final_value=final_value,
        band=width,
        rise_start=_crossing(times, share, 0.1),
        rise_end=_crossing(times, share, 0.9),
        settled=_settled(times, values, final_value, width, begin),
        overshoot=over,
        peak_time=float(times[peak]) if over > 0 else None,
        peak=float(values[peak]) if over > 0 else None,
    )


def _crossing(times: np.ndarray, share: np.ndarray, level: float) -> float | None:
    """Return the time of the first crossing of the level, interpolated between samples; None without one."""
    above = np.flatnonzero(share >= level)
    if not above.size:
        return None
    at = int(above[0])
    if at == 0:
        return float(times[0])
    part = (level - share[at - 1]) / (share[at] - share[at - 1])
    return float(times[at - 1] + part * (times[at] - times[at - 1]))


def _settled(
    times: np.ndarray, values: np.ndarray, final_value: float, band: float, begin: float
) -> float | None:
    outside = np.flatnonzero(np.abs(values - final_value) > band)
    if not outside.size:
        return begin
    last = int(outside[-1])
    if last == times.size - 1:
        return None
    settled = float(times[last + 1])
    stayed = float(times[-1]) - settled
    return settled if stayed >= STAY * (float(times[-1]) - begin) else None
