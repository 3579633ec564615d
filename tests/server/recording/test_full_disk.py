"""Recording on a real disk that fills up: a small tmpfs in its own mount namespace."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from server.platform.disk_reserve import RESERVE_BYTES
from tests.stack import ROOT
from tests.waiting import SECONDS


def on_small_disk(folder: Path, *command: str, size: str = "4m") -> subprocess.CompletedProcess[str]:
    mount = f'mount -t tmpfs -o size={size} tmpfs "{folder}" && exec "$@"'
    return subprocess.run(
        ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", mount, "sh", *command],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )


def perform(tmp_path: Path, act: str, size: str) -> Any:
    """Perform an act of `tests.server.full_disk` on a disk of this size; return what it tells."""
    try:
        trial = on_small_disk(tmp_path, "true")
    except FileNotFoundError:
        pytest.skip("there is no unshare(1) here")
    if trial.returncode != 0:
        pytest.skip(f"this computer lets nobody mount a small disk: {trial.stderr.strip()}")
    command = (sys.executable, "-m", "tests.server.full_disk", str(tmp_path), act)
    done = on_small_disk(tmp_path, *command, size=size)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_session_can_be_removed_from_a_disk_without_a_free_byte(tmp_path: Path) -> None:
    report = perform(tmp_path, "purge", "22m")
    assert "full" in report["refused"]
    assert (report["reserved"], report["given_up"], report["listed"]) == (RESERVE_BYTES, True, [1])
    assert (report["reserved_again"], report["integrity"]) == (RESERVE_BYTES, "ok")


def test_recording_loses_nothing_when_the_disk_is_full_for_a_while(tmp_path: Path) -> None:
    report = perform(tmp_path, "record", "4m")
    assert report["refusals"] == [
        "the disk is full: free some space on the computer that holds the data folder"
    ]
    assert 0 < report["stored_when_full"] < report["sent"]
    assert (report["stored"], report["state"]) == (report["sent"], "complete")
    assert (report["integrity"], report["gaps"], report["holes"]) == ("ok", [], 0)
    assert len(report["refused_beside"]) == 3
    for refusal in report["refused_beside"]:
        # The path may hold any word.
        text = refusal.replace(str(tmp_path), "")
        assert "disk" in text
        assert "full" in text
    assert report["cells"] == [0, 1]


def test_where_the_disk_is_full_the_film_goes_before_the_samples(tmp_path: Path) -> None:
    report = perform(tmp_path, "film", "16m")
    assert len(report["told"]) == 1
    assert "the disk is full" in report["told"][0]
    sent, stored, full, shown = (report[name] for name in ("sent", "stored", "full", "shown"))
    assert (report["state"], report["integrity"]) == ("complete", "ok")
    assert stored["depth"] == sent["depth"]
    (gap,) = report["missed"]
    assert (gap["topic"], gap["kind"]) == ("film", "not stored")
    assert stored["film"] + gap["missed"] == sent["film"]
    # It plays to the moment at which the disk was full, and on from there.
    assert shown == [*range(full), *range(sent["film"] - (stored["film"] - full), sent["film"])]
