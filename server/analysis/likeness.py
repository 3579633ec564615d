"""Likeness of parts of sessions: only of like parts is one figure better than another."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations

from pydantic import Field

from server.analysis.moments import Span
from server.analysis.segment import TOGETHER, Segment
from server.platform.schema_base import Schema

SET_POINTS_APART = 0.05
"""m"""
FACTOR = 2.0
"""Between the durations."""
ROUNDING = 1e-9
NO_SEGMENT = "This session has no such segment."


class Likeness(Schema):
    """Likeness of the compared parts: the same segments by mode, set point and duration."""

    alike: bool
    why: str = Field(description="why not, for a person; empty where they are")


def parts_within(segments: Iterable[Segment], spans: Sequence[Span]) -> list[Segment]:
    """Return the segments as far as they lie in these spans, without what is shorter than TOGETHER."""
    return list(_cut(segments, spans))


def _cut(segments: Iterable[Segment], spans: Sequence[Span]) -> Iterator[Segment]:
    for segment in segments:
        for span in spans:
            start, end = max(segment.start, span.start), min(segment.end, span.end)
            if end - start >= min(TOGETHER, segment.end - segment.start) > 0:
                yield segment.model_copy(update={"start": start, "end": end})


def judge(parts: Sequence[tuple[str, Sequence[Segment]]]) -> Likeness:
    """Return whether these parts are alike, each with its session's name."""
    for name, segments in parts:
        if len(parts) > 1 and not segments:
            return _unlike(f"“{name}” was not armed in this part")
    for (name, segments), (other, others) in combinations(parts, 2):
        if len(segments) != len(others):
            counts = f"“{name}” has {_count(segments)}, “{other}” has {_count(others)}"
            return _unlike(f"{counts}. Choose a segment of each")
        for segment, other_segment in zip(segments, others, strict=True):
            if why := _difference(name, segment, other, other_segment):
                return _unlike(why)
    return Likeness(alike=True, why="")


def choose_segments(
    sessions: Sequence[Sequence[Segment]], chosen: Sequence[int | None]
) -> list[Segment | None]:
    """Return a segment of each session: the chosen one (from 1 on), otherwise the one most like the others'.

    The first session's is the one that most of the others have, too; of several the longest. A session
    without any, or without the chosen one, has None.
    """
    offered = [
        segments if number is None else segments[number - 1 : number]
        for segments, number in zip(sessions, chosen, strict=True)
    ]
    model: Segment | None = None
    picked: list[Segment | None] = []
    for number, segments in enumerate(offered):
        if not segments:
            picked.append(None)
            continue
        if model is None:
            rest = offered[number + 1 :]
            model = max(segments, key=lambda segment: _commonness(segment, rest))
            picked.append(model)
        else:
            like = model
            picked.append(max(segments, key=lambda segment: _closeness(segment, like)))
    return picked


def _commonness(segment: Segment, sessions: Sequence[Sequence[Segment]]) -> tuple[int, bool, float]:
    shared = sum(any(_alike(segment, other) for other in others) for others in sessions)
    return shared, segment.holds_depth, _length(segment)


def _closeness(segment: Segment, model: Segment) -> tuple[bool, bool, float]:
    ratio = min(_length(segment), _length(model)) / max(_length(segment), _length(model), ROUNDING)
    return _alike(segment, model), segment.holds_depth == model.holds_depth, ratio


def _alike(segment: Segment, other: Segment) -> bool:
    return not _difference("", segment, "", other)


def _difference(name: str, segment: Segment, other_name: str, other: Segment) -> str:
    """Return what makes these two unlike; empty where nothing does."""
    if segment.mode != other.mode:
        modes = segment.mode or "unknown", other.mode or "unknown"
        return f"“{name}” is in mode {modes[0]}, “{other_name}” in {modes[1]}"
    if not _same_set_point(segment, other):
        return f"“{name}” {_held(segment)}, “{other_name}” {_held(other)}"
    short, long = sorted((_length(segment), _length(other)))
    if long > FACTOR * short + ROUNDING:
        return f"“{name}” lasts {_length(segment):.1f} s, “{other_name}” {_length(other):.1f} s"
    return ""


def _same_set_point(segment: Segment, other: Segment) -> bool:
    if segment.holds_depth != other.holds_depth:
        return False
    if segment.set_point is None or other.set_point is None:
        return segment.set_point == other.set_point
    return abs(segment.set_point - other.set_point) <= SET_POINTS_APART + ROUNDING


def _held(segment: Segment) -> str:
    if not segment.holds_depth:
        return "holds no depth"
    return "follows a moving set point" if segment.set_point is None else f"holds {segment.set_point:.2f} m"


def _length(segment: Segment) -> float:
    return segment.end - segment.start


def _count(segments: Sequence[Segment]) -> str:
    return "1 segment" if len(segments) == 1 else f"{len(segments)} segments"


def _unlike(why: str) -> Likeness:
    return Likeness(alike=False, why=f"No value is marked as better, because the parts are not alike: {why}.")
