"""Half a minute of `make chaos`."""

import json
from pathlib import Path

import pytest

from tests.proofs.chaos import run

pytestmark = pytest.mark.stack


def test_losses_in_half_a_minute_of_chaos_are_counted(tmp_path: Path) -> None:
    report = json.loads(run(30.0, 4, tmp_path))
    assert report["problems"] == []
    assert report["samples"] > 0
    assert sum(report["done"].values()) >= 5
