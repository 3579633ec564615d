"""Parts of sessions that are alike or not, and the segments that are compared of themselves."""

import pytest

from server.analysis.likeness import choose_segments, judge, parts_within
from server.analysis.moments import Span
from server.analysis.segment import Segment


def held(start: float, end: float, set_point: float | None = 1.0, mode: str = "automatic") -> Segment:
    return Segment(
        start=start,
        end=end,
        mode=mode,
        controller="pid",
        title="PID",
        gains={},
        holds_depth=mode == "automatic",
        set_point=set_point,
    )


@pytest.mark.parametrize(
    ("other", "why"),
    [
        (held(5, 25, 1.05), ""),
        (held(5, 25, 1.06), "“a” holds 1.00 m, “b” holds 1.06 m"),
        (held(0, 80), ""),
        (held(0, 81), "“a” lasts 40.0 s, “b” 81.0 s"),
        (held(0, 19), "“a” lasts 40.0 s, “b” 19.0 s"),
        (held(0, 40, None), "“a” holds 1.00 m, “b” follows a moving set point"),
        (held(0, 40, None, "manual"), "“a” is in mode automatic, “b” in manual"),
        (held(0, 40).model_copy(update={"controller": "bang_bang", "gains": {"u": 1.0}}), ""),
    ],
)
def test_alike_are_the_same_mode_set_point_and_about_the_same_duration(other: Segment, why: str) -> None:
    for order in (1, -1):
        likeness = judge([("a", [held(0, 40)]), ("b", [other])][::order])
        assert likeness.alike == (why == "")
        if order == 1:
            assert likeness.why == (
                why and f"No value is marked as better, because the parts are not alike: {why}."
            )


def test_every_two_of_several_must_be_alike() -> None:
    three = [("a", [held(0, 9, 1.0)]), ("b", [held(0, 9, 1.04)]), ("c", [held(0, 9, 0.96)])]
    assert judge(three[:2]).alike
    assert "“b” holds 1.04 m, “c” holds 0.96 m" in judge(three).why


def test_a_dive_of_several_segments_is_like_one_of_the_same_segments() -> None:
    mixed = [held(0, 20, 0.5), held(20, 60)]
    assert judge([("a", mixed), ("b", [held(0, 18, 0.5), held(18, 70)])]).alike
    assert not judge([("a", mixed), ("b", [held(0, 20), held(20, 60, 0.5)])]).alike
    assert judge([("a", [])]).alike
    assert "“b” was not armed" in judge([("a", mixed), ("b", [])]).why


def test_a_part_takes_of_its_segments_what_lasts() -> None:
    mixed = [held(0, 20, 0.5), held(20, 60)]
    parts = parts_within(mixed, [Span(19.5, 30)])
    assert [(part.start, part.end) for part in parts] == [(20, 30)]


def test_the_segments_most_alike_are_compared_of_themselves() -> None:
    deeper = [held(0, 50, 0.5), held(50, 60), held(60, 70, 2.0)]
    flat = [held(0, 20, None, "manual"), held(20, 23), held(23, 35)]
    assert choose_segments([deeper, flat], [None, None]) == [deeper[1], flat[2]]
    assert choose_segments([deeper, flat], [1, None]) == [deeper[0], flat[2]]
    assert choose_segments([deeper, flat, []], [3, 1, None]) == [deeper[2], flat[0], None]
    assert choose_segments([deeper, flat], [4, None]) == [None, flat[2]]
