"""The report as a file, from the shell."""

from pathlib import Path

import pytest

from server.cli import main
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.analysis.dives import dive, record


def test_the_report_is_one_self_contained_file(store: Store, settings: Settings, tmp_path: Path) -> None:
    sessions = [
        record(store, settings, dive(gains={"kp": 3.0}), name="calm <b>"),
        record(store, settings, dive(gains={"kp": 6.0}), name="hasty"),
    ]
    out = tmp_path / "report.html"
    options = ["--data", str(settings.data.path), "--config", str(settings.config), "-o", str(out)]
    assert main(["report", *map(str, sessions), *options]) == 0
    text = out.read_text(encoding="utf-8")
    assert "calm &lt;b&gt;, hasty" in text
    assert "<td>In force: PID: kp</td><td>3</td><td>6</td>" in text
    assert "Time 0 is arming." in text
    assert "Step from 0.00 m to 0.50 m." in text
    assert "Plotly.newPlot" in text
    assert text.count('"symbol":["line-ns"') == 2
    assert "No value is marked as better" not in text
    assert "<small>2.5 to 32.5 s of the recording</small>" in text
    assert 'src="http' not in text
    assert 'rel="stylesheet"' not in text


def test_a_report_of_unlike_segments_says_so(store: Store, settings: Settings, tmp_path: Path) -> None:
    first, second = (record(store, settings, dive(), name=name) for name in ("first", "second"))
    out = tmp_path / "report.html"
    options = ["--data", str(settings.data.path), "--config", str(settings.config), "-o", str(out)]
    chosen = ["--align", "segment", "--over", "segment", "--segments", f"{first}:1,{second}:2"]
    assert main(["report", str(first), str(second), *chosen, *options]) == 0
    text = out.read_text(encoding="utf-8")
    assert "Time 0 is the beginning of the segment." in text
    assert "the parts are not alike: “first” holds 0.50 m, “second” holds 1.00 m." in text
    assert "<small>12.5 to 32.5 s of the recording</small>" in text


@pytest.mark.usefixtures("store")
def test_an_impossible_report_is_refused_in_one_line(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "report.html"
    options = ["--data", str(settings.data.path), "--config", str(settings.config), "-o", str(out)]
    assert main(["report", "7", *options]) == 1
    assert "There is no session 7" in capsys.readouterr().err
    assert main(["report", "7", "--signals", "depth", *options]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "signals.0: " in line
    assert main(["report", "7", "--align", "set_point", "--step", "0", *options]) == 2
    assert "0 is not in the range x>=1" in capsys.readouterr().err
    assert main(["report", "7", "--segments", "second", *options]) == 1
    assert "segments are written as 7:2,9:1" in capsys.readouterr().err
    assert not out.exists()
