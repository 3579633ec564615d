"""The thesis's whole example, 75 cells, from the shell; the browser tests use the same shipped run."""

import json
from pathlib import Path
from typing import Any

import pytest

from bench.samples import FOLDER
from server.cli import main
from server.features.comm_tests.shipped import THESIS
from server.platform.settings import Settings
from tests.board.rig import ROOT, build


@pytest.mark.stack  # Its uploads fail where others starve them of the processor.
@pytest.mark.timeout(1200)
def test_the_example_of_the_thesis_gives_the_shipped_results(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    build(ROOT / "firmware/emulator")
    build(ROOT / "firmware/bootloader")
    options = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert main(["commtest", "run", str(THESIS), *options]) == 0
    assert "[ 75/75]" in capsys.readouterr().out
    assert main(["commtest", "export", "1", "--format", "json", *options]) == 0
    run: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert (run["state"], run["problem"], run["place"]) == ("complete", "", "emulated")
    assert [cell["number"] for cell in run["cells"]] == list(range(75))
    assert run["cells"] == read(FOLDER / "grid-thesis.json")["cells"], "make samples"


def read(path: Path) -> dict[str, Any]:
    run: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return run
