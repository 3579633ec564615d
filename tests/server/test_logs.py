from pathlib import Path

import pytest

import server.logs as logs_module
from server.logs import PartLog


def test_the_file_is_bounded_and_nothing_recent_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs_module, "FILE_BYTES_MAX", 100)
    log = PartLog(tmp_path / "part.log")
    for number in range(50):
        log.write(f"line {number:02}\n".encode())
    log.close()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["part.log", "part.log.1"]
    text = (tmp_path / "part.log.1").read_text() + (tmp_path / "part.log").read_text()
    assert text.endswith("".join(f"line {number:02}\n" for number in range(38, 50)))
    assert all(path.stat().st_size <= 100 for path in tmp_path.iterdir())


def test_the_last_lines_are_remembered_however_they_arrive(tmp_path: Path) -> None:
    log = PartLog(tmp_path / "part.log")
    for piece in (b"one\ntw", b"o\n\n  \nthr", b"ee\r\nfo", b"ur"):
        log.write(piece)
    assert log.last(3) == "two / three / four"
    assert log.last(1) == "four"
    log.write(b"\xff" * 10_000)
    assert len(log.last(1)) <= 2000
    log.close()
    assert PartLog(tmp_path / "other.log").last(3) == ""


def test_a_log_that_cannot_be_written_harms_nobody(tmp_path: Path) -> None:
    log = PartLog(tmp_path / "missing" / "part.log")
    log.write(b"said\n")
    assert log.last(1) == "said"
    log.close()
