"""The later firmware of `make services`' updates must be another for the updater."""

import shutil
from pathlib import Path

from robot_runtime.config import LinkConfig
from robot_runtime.places import BUILD
from robot_runtime.simulation.boards.firmware import firmware_path
from server.features.board.previous_firmware import store_if_other
from tests.proofs.real_board import mark_firmware


def test_a_marked_firmware_is_another_one_both_ways(tmp_path: Path) -> None:
    built, marked = firmware_path(BUILD, LinkConfig().baud, ".hex"), tmp_path / "marked.hex"
    shutil.copy(built, marked)
    mark_firmware(marked)
    previous = tmp_path / "previous.hex"
    assert store_if_other(marked, built, previous) == "other"
    assert store_if_other(built, marked, previous) == "other"
