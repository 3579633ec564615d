"""The lines between water and board: complete, split, malformed."""

from math import nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.simulation.boards.board_protocol import (
    LINE_BYTES_MAX,
    BoardLineError,
    LineBuffer,
    read_fins,
    write_sense,
)
from robot_runtime.simulation.water.sensors import Reading

FINS = "fins 1.25 0.1 0.2 0.3 0.4 1 2 3 4 10 -20 30 -40 1 0"
SENSE = Reading(
    106230.04, 15.0, (0.1, -0.2, -9.81), (0.001, 0.002, -0.003), True, False, 7.89, (0.01, -0.02, nan, 0.0)
)


def test_a_fins_line_is_parsed() -> None:
    fins = read_fins(FINS)
    assert fins.angles == (0.1, 0.2, 0.3, 0.4)
    assert fins.speeds == (1, 2, 3, 4)
    assert fins.drives == (10, -20, 30, -40)
    assert fins.powered
    assert not read_fins(FINS.replace(" 1 0", " 0 1")).powered


@pytest.mark.parametrize(
    "line",
    [
        "fins",
        "ok",
        FINS + " 5",
        FINS.rsplit(" ", 1)[0],
        FINS.replace("0.3", "zero"),
        FINS.replace("0.3", "nan"),
        FINS.replace("0.3", "inf"),
        FINS.replace("0.3", "1e9"),
        FINS.replace("1.25", "nan"),
    ],
)
def test_an_invalid_fins_line_is_refused(line: str) -> None:
    with pytest.raises(BoardLineError, match=r"is not|impossible fins|could not convert"):
        read_fins(line)


def test_a_sense_line_holds_the_reading() -> None:
    assert write_sense(SENSE) == (
        "sense 106230.0 15.00 0.100000 -0.200000 -9.810000 0.001000 0.002000 -0.003000 1 0 7.8900 "
        "0.01000 -0.02000 nan 0.00000 1.0000\n"
    )


@given(st.lists(st.integers(1, 40)))
def test_lines_are_reassembled_from_any_pieces(cuts: list[int]) -> None:
    expected = [FINS, "error no", "", "ok 2"]
    data = "".join(line + "\n" for line in expected).encode()
    lines, got, at = LineBuffer(), list[str](), 0
    for cut in [*cuts, len(data)]:
        got += lines.feed(data[at : at + cut])
        at += cut
    assert got == expected


def test_a_line_without_end_is_refused() -> None:
    lines = LineBuffer()
    with pytest.raises(BoardLineError, match="more than"):
        list(lines.feed(b"x" * (LINE_BYTES_MAX + 1)))


def test_bytes_that_are_no_text_are_ignored() -> None:
    assert len(list(LineBuffer().feed(b"\xff\xfe\n"))) == 1
