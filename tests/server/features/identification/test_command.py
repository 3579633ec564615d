"""`mucat identify` on sessions of the firmware: table, craft file, report, refusals."""

from pathlib import Path

import pytest

from robot_runtime.contract.craft import load_craft
from server.cli import main
from tests.server.features.identification.conftest import RecordedTrials


def run(trials: RecordedTrials, *arguments: str) -> int:
    where = ["--data", str(trials.data.path), "--config", str(trials.config)]
    return main(["identify", *arguments, *where])


@pytest.mark.usefixtures("quick_fit")
def test_recorded_sessions_give_a_craft_file_and_a_report(
    trials: RecordedTrials, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, report = tmp_path / "craft.toml", tmp_path / "report.html"
    assert run(trials, "1", "--leave-out", "2", "--out", str(out), "--report", str(report)) == 0
    output = capsys.readouterr()
    assert "Thrust coefficient of the fins" in output.out
    assert "not seen in these sessions: it needs swimming sideways" in output.out
    assert "Prediction of Sea trial, which was left out: the error is" in output.out
    assert "Fitting" in output.err
    craft = load_craft(out)
    assert craft.title == "Fitted to Sea trial"
    assert craft.craft.fin_drag == pytest.approx(0.22, rel=0.05)
    assert craft.craft.buoyancy_height == pytest.approx(0.0085, rel=0.05)
    text = report.read_text()
    assert "Not seen in these sessions" in text
    # The chart of measured over predicted signals, and the library that draws it.
    assert text.count('"legendgroup":"measured"') == 7
    assert "plotly" in text.lower()


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (("1", "--leave-out", "1"), "Session 1 cannot be both fitted and left out"),
        (("9",), "There is no session 9"),
        (tuple("1" * 13), "A fit takes 12 sessions at most"),
        (("1", "--out", "/nowhere/craft.toml"), "/nowhere/craft.toml cannot be written. Name another file."),
    ],
)
@pytest.mark.usefixtures("quick_fit")
def test_what_cannot_be_done_is_refused_in_words(
    trials: RecordedTrials,
    arguments: tuple[str, ...],
    why: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(trials, *arguments) == 1
    assert why in capsys.readouterr().err


def test_a_missing_package_is_named(
    trials: RecordedTrials, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("server.features.identification.run.find_spec", lambda _: None)
    assert run(trials, "1") == 1
    assert "needs the package scipy, which is not installed" in capsys.readouterr().err
