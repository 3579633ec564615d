"""The report of the long proofs: their results, and their resumption."""

import json
import sys
from pathlib import Path

import pytest

from tests.proofs import report
from tests.proofs.report import Outcome, Proof

MAKEFILE = "good:\n\t@echo all is well\nbad:\n\t@echo one was lost; exit 3\nlater:\n\t@date +%N >> ran\n"
PROOFS = (Proof("good", "It works."), Proof("bad", "It never fails."), Proof("later", "It goes on."))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "Makefile").write_text(MAKEFILE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(report, "PROOFS", PROOFS)
    monkeypatch.setattr(report, "commit", lambda: "c0ffee")
    monkeypatch.setattr(sys, "argv", ["report"])
    return tmp_path


def outcomes(folder: Path) -> dict[str, Outcome]:
    stored = json.loads((folder / "build/proofs/outcomes.json").read_text())
    return {name: Outcome(**one) for name, one in stored.items()}


def test_a_failed_proof_is_reported_and_the_next_ones_run(folder: Path) -> None:
    assert report.main() == 1
    text = (folder / "build/proofs/report.md").read_text()
    assert "| [good](#good) | It works. | held | 0 |" in text
    assert "| [bad](#bad) | It never fails. | **failed** (status 2) | 0 |" in text
    assert "| [later](#later) | It goes on. | held | 0 |" in text
    assert "one was lost" in text
    assert outcomes(folder)["good"].said == "all is well"


def test_a_proof_with_a_result_on_this_commit_is_not_run_again(folder: Path) -> None:
    report.main()
    report.main()
    assert len((folder / "ran").read_text().splitlines()) == 1


def test_a_named_proof_is_run_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    report.main()
    monkeypatch.setattr(sys, "argv", ["report", "later"])
    report.main()
    assert len((folder / "ran").read_text().splitlines()) == 2


def test_results_of_another_commit_do_not_count(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    report.main()
    monkeypatch.setattr(report, "commit", lambda: "decade")
    monkeypatch.setattr(sys, "argv", ["report", "good"])
    report.main()
    text = (folder / "build/proofs/report.md").read_text()
    assert "| [good](#good) | It works. | held | 0 |" in text
    assert "| [bad](#bad) | It never fails. | not run |  |" in text


@pytest.mark.usefixtures("folder")
def test_an_unknown_proof_is_refused_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["report", "luck"])
    with pytest.raises(SystemExit, match="no proof luck; there are good, bad, later"):
        report.main()


def test_every_proof_is_a_target_of_the_makefile() -> None:
    targets = Path("Makefile").read_text()
    assert [proof.target for proof in report.PROOFS if f"\n{proof.target}:" not in targets] == []
