"""The report of the long proofs: their results, and their resumption."""

import json
import os
import sys
from pathlib import Path

import pytest

from tests.proofs import page, report
from tests.proofs.report import ProofOutcome
from tests.proofs.stages import STAGES, Lane, Proof, Stage

MAKEFILE = """
good:
	@echo all is well
bad:
	@echo one was lost; exit 3
later:
	@date +%N >> ran
part:
	@echo "part <$(ONLY)>"
halted:
	@trap 'echo robots ended > ended; exit 1' INT; kill -$(PROOF_SIGNAL) $(PROOF_PID); sleep 60
"""
PROOFS = (
    Proof("good", "It works.", "Once."),
    Proof("bad", "It never fails.", "Once."),
    Proof("later", "It goes on.", "Once."),
)


def one_lane(*proofs: Proof) -> tuple[Stage, ...]:
    return ((Lane(proofs),),)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "Makefile").write_text(MAKEFILE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(report, "STAGES", one_lane(*PROOFS))
    monkeypatch.setattr(report, "commit", lambda: "c0ffee")
    monkeypatch.setattr(sys, "argv", ["report"])
    for path in (page.PAGE, page.RESULTS):
        path.parent.mkdir(parents=True)
    page.RESULTS.write_text('{"bad": {"held": true, "minutes": 7}}')
    return tmp_path


def outcomes(folder: Path) -> dict[str, ProofOutcome]:
    stored = json.loads((folder / "build/proofs/outcomes.json").read_text())
    return {name: ProofOutcome(**values) for name, values in stored.items()}


def test_a_proof_is_run_whole_where_it_is_chosen_by_name(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report, "STAGES", one_lane(Proof("part", "It is whole.", "Once.")))
    monkeypatch.setattr(sys, "argv", ["report", "part"])
    monkeypatch.setenv("ONLY", "part")
    monkeypatch.setenv("MAKEFLAGS", " -- ONLY=part")
    assert report.main() == 0
    assert outcomes(folder)["part"].said == "part <>"


def test_a_failed_proof_is_reported_and_the_next_ones_run(folder: Path) -> None:
    assert report.main() == 1
    text = (folder / "build/proofs/report.md").read_text()
    assert "| [good](#good) | It works. | held | 0 |" in text
    assert "| [bad](#bad) | It never fails. | **failed** (status 2) | 0 |" in text
    assert "| [later](#later) | It goes on. | held | 0 |" in text
    assert "one was lost" in text
    assert outcomes(folder)["good"].said == "all is well"


def test_each_result_is_stored_and_the_page_of_the_manual_is_written(folder: Path) -> None:
    report.main()
    results = page.read()
    assert {name: result["held"] for name, result in results.items()} == {
        "good": True,
        "bad": False,
        "later": True,
    }
    assert "| not run |" in (folder / page.PAGE).read_text()
    text = page.text(PROOFS, results)
    assert "| It works. | Once. | held | 0 | `make good` |" in text
    assert "| It never fails. | Once. | **failed** | 0 | `make bad` |" in text


def test_the_page_of_the_manual_is_that_of_the_stored_results() -> None:
    proofs = [proof for stage in STAGES for lane in stage for proof in lane.proofs]
    results = page.read()
    assert results.keys() <= {proof.target for proof in proofs}
    assert page.PAGE.read_text(encoding="utf-8") == page.text(proofs, results)


def test_a_proof_with_a_result_on_this_commit_is_not_run_again(folder: Path) -> None:
    report.main()
    report.main()
    assert len((folder / "ran").read_text().splitlines()) == 1


@pytest.mark.usefixtures("folder")
def test_an_unknown_proof_is_refused_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["report", "luck"])
    with pytest.raises(SystemExit, match="no proof luck; there are good, bad, later"):
        report.main()


def test_every_proof_is_a_target_of_the_makefile() -> None:
    targets = Path("Makefile").read_text()
    proofs = [proof for stage in STAGES for lane in stage for proof in lane.proofs]
    assert [proof.target for proof in proofs if f"\n{proof.target}:" not in targets] == []
    assert len({proof.target for proof in proofs}) == len(proofs)


@pytest.mark.parametrize("signal", ["INT", "TERM"])
def test_an_interrupted_proof_ends_its_robots_has_no_result_and_none_begins_after_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], signal: str
) -> None:
    monkeypatch.setenv("PROOF_SIGNAL", signal)
    monkeypatch.setenv("PROOF_PID", f"{os.getpid()}")
    good, _, later = PROOFS
    stages = one_lane(good, Proof("halted", "It waits.", "Once."), later)
    monkeypatch.setattr(report, "STAGES", stages)
    assert report.main() == 1
    assert (folder / "ended").exists()
    assert set(outcomes(folder)) == {"good"}
    assert not (folder / "ran").exists()
    assert "Interrupted; the same command goes on." in capsys.readouterr().out
