"""The end of a run: met, missed and not measured, and the status that says so to a program."""

from pathlib import Path

import pytest

from bench.__main__ import summarise
from bench.goals import GOALS
from bench.results import Results


@pytest.fixture
def results(tmp_path: Path) -> Results:
    return Results(tmp_path / "bench.json")


def test_a_met_goal_is_status_0(results: Results, capsys: pytest.CaptureFixture[str]) -> None:
    results.add("physics", {"physics.speed_x": 90.0}, {"python": 1.0})
    assert summarise(results, {"physics"}, is_whole=False) == 0
    assert "1 goals met, 0 missed" in capsys.readouterr().out


def test_a_missed_goal_is_named_and_is_status_1(results: Results, capsys: pytest.CaptureFixture[str]) -> None:
    results.add("physics", {"physics.speed_x": 20.0}, {"python": 1.0})
    assert summarise(results, {"physics"}, is_whole=False) == 1
    assert "MISSED" in capsys.readouterr().out


def test_a_goal_is_scaled_by_the_calibration_beside_its_figure(results: Results) -> None:
    results.add("physics", {"physics.speed_x": 20.0}, {"python": 1.5})
    assert summarise(results, {"physics"}, is_whole=False) == 0


def test_a_failed_part_is_named_and_is_status_1(results: Results, capsys: pytest.CaptureFixture[str]) -> None:
    results.fail("stack", "no server comes")
    assert summarise(results, {"stack"}, is_whole=False) == 1
    assert "stack: no server comes" in capsys.readouterr().out


def test_a_short_run_names_the_goals_of_the_long_parts_and_does_not_fail_for_them(
    results: Results, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("bench.__main__.GOALS", {"firmware.missed_ticks": GOALS["firmware.missed_ticks"]})
    assert summarise(results, set(), is_whole=True, left_out={"firmware", "comm_test"}) == 0
    assert "firmware.missed_ticks" in capsys.readouterr().out
    assert summarise(results, set(), is_whole=True) == 1


def test_in_a_whole_run_a_goal_without_a_figure_is_named_and_is_status_1(
    results: Results, capsys: pytest.CaptureFixture[str]
) -> None:
    assert summarise(results, set(), is_whole=True) == 1
    assert "page.redraw_ms" in capsys.readouterr().out
