"""The lake of Parquet files: figures of all sessions and topics of each, written once."""

from pathlib import Path

import pyarrow.parquet as pq
import pytest
from sqlmodel import insert

from server.cli import main
from server.platform.models import SessionFiguresRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import depth_block
from tests.server.features.exports.recordings import record_batches

BOTH_DATABASES = True


async def test_a_lake_has_figures_and_topics_and_writes_none_twice(
    store: Store, settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sessions = [await record_batches(store, settings, [depth_block(0, 100)]) for _ in range(2)]
    figures = {"controller": "PID", "gains": "kp 3", "craft": "", "rmse": 0.02}
    rows = [{"session_id": session, "segment": 0, **figures} for session in sessions]
    await store.execute(insert(SessionFiguresRow), rows)
    arguments = [
        "lab",
        "lake",
        str(tmp_path / "lake"),
        "--topics",
        "depth",
        "--data",
        str(settings.data.path),
    ]
    assert main(arguments) == 0
    assert "depth of 2 sessions" in capsys.readouterr().out
    table = pq.read_table(tmp_path / "lake/figures.parquet").to_pylist()
    assert [(row["rmse"], row["overshoot"], row["robot"]) for row in table] == [(0.02, None, "tested")] * 2
    identifier = find_row(store, sessions[0]).identifier
    file = tmp_path / f"lake/depth/session={identifier}/data.parquet"
    assert pq.read_table(file, partitioning=None).num_rows == 100
    written = file.stat().st_mtime_ns
    assert main(arguments) == 0
    assert file.stat().st_mtime_ns == written
