"""Segments of a dive: the times between changes of mode, controller, gains and set point, while armed.

The figures of a dive in which several controllers swam mean little; those of a segment are of one controller
with one set point. What changes within a second changes together, as when a mission's step chooses controller
and set point. A set point that changes on and on, as on a ramp, makes a segment in which it moves.
"""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from typing import Protocol, TypeVar

import numpy as np

from server.analysis.history import set_point_steps
from server.analysis.moments import ControlHistory, ControlPeriod, ModePeriod, Span
from server.analysis.segment import TOGETHER, Segment
from server.metrics.series import Series


class _Timed(Protocol):
    @property
    def time(self) -> float: ...


T = TypeVar("T", bound=_Timed)


def find_segments(history: ControlHistory, set_point: Series | None, duration: float) -> list[Segment]:
    """Return the segments in order of time, of a session that lasts `duration` s."""
    steps = [time for time, _ in set_point_steps(set_point, history.armed)] if set_point is not None else []
    segments: list[Segment] = []
    for armed in history.armed:
        span = Span(max(armed.start, 0.0), min(armed.end, duration))
        for segment in _cut(span, history, set_point, steps):
            last = segments[-1] if segments else None
            if last is not None and last.end == segment.start and _alike(last, segment):
                last.end = segment.end
            else:
                segments.append(segment)
    return segments


def _cut(
    span: Span, history: ControlHistory, set_point: Series | None, steps: Sequence[float]
) -> Iterator[Segment]:
    held = [time for time in steps if _holds_depth(history, time)]
    changes = [*(control.time for control in history.controls), *(mode.time for mode in history.modes), *held]
    groups: list[list[float]] = [[span.start]]
    for time in sorted(time for time in changes if span.start < time < span.end):
        if time - groups[-1][-1] < TOGETHER:
            groups[-1].append(time)
        else:
            groups.append([time])
    if len(groups) > 1 and span.end - groups[-1][-1] < TOGETHER:
        del groups[-1]
    for group, end in zip(groups, [*(group[0] for group in groups[1:]), span.end], strict=True):
        start, last = group[0], group[-1]
        if last - start >= TOGETHER:
            yield _describe(Span(start, last), start, history, None)
            start = last
        yield _describe(Span(start, end), last, history, set_point)


def _describe(span: Span, time: float, history: ControlHistory, set_point: Series | None) -> Segment:
    """Return the segment with what was in force at this time (s)."""
    mode, control = _in_force(history.modes, time), _in_force(history.controls, time)
    is_held = _holds_depth(history, time)
    value: float | None = None
    if is_held and set_point is not None and set_point.times.size:
        # The change is in force from the tick on at which it began.
        at = min(int(np.searchsorted(set_point.times, time, "left")), set_point.times.size - 1)
        value = round(float(set_point.values[at]), 3)
    shown: ControlPeriod | None = control if is_held else None
    return Segment(
        start=span.start,
        end=span.end,
        mode="" if mode is None else mode.mode,
        controller="" if shown is None else shown.controller,
        title="" if shown is None else shown.title,
        gains={} if shown is None else shown.gains,
        holds_depth=is_held,
        set_point=value,
    )


def _holds_depth(history: ControlHistory, time: float) -> bool:
    mode: ModePeriod | None = _in_force(history.modes, time)
    return mode is None or mode.holds_depth


def _in_force(periods: Sequence[T], time: float) -> T | None:
    """Return the last of these that began by this time; before the first one that one. None without any."""
    at = bisect_right(periods, time, key=lambda period: period.time)
    return periods[max(at - 1, 0)] if periods else None


def _alike(before: Segment, after: Segment) -> bool:
    return before.model_copy(update={"start": after.start, "end": after.end}) == after
