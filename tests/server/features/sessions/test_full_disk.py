"""Recording on a real disk that fills up: a small tmpfs in its own mount namespace."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.stack import ROOT

DISK = "4m"


def on_small_disk(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    mount = f'mount -t tmpfs -o size={DISK} tmpfs "{folder}" && exec "$@"'
    return subprocess.run(
        ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", mount, "sh", *command],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_recording_loses_nothing_when_the_disk_is_full_for_a_while(tmp_path: Path) -> None:
    try:
        trial = on_small_disk(tmp_path, "true")
    except FileNotFoundError:
        pytest.skip("there is no unshare(1) here")
    if trial.returncode != 0:
        pytest.skip(f"this computer lets nobody mount a small disk: {trial.stderr.strip()}")
    done = on_small_disk(tmp_path, sys.executable, "-m", "tests.server.full_disk", str(tmp_path))
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["refusals"] == [
        "the disk is full: free some space on the computer that holds the data folder"
    ]
    assert 0 < told["stored_when_full"] < told["sent"]
    assert (told["stored"], told["state"]) == (told["sent"], "complete")
    assert (told["integrity"], told["gaps"], told["holes"]) == ("ok", [], 0)
    assert len(told["refused_beside"]) == 3
    for refusal in told["refused_beside"]:
        # The path may hold any word.
        words = refusal.replace(str(tmp_path), "")
        assert "disk" in words
        assert "full" in words
    assert told["cells"] == [0, 1]
