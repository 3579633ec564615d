import subprocess
from pathlib import Path

import pytest

import server.processes.logs as logs_module
from server.processes.logs import ProcessLog
from tests.server.waiting import SECONDS


def test_logs_are_limited_in_size_and_keep_the_newest_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs_module, "FILE_BYTES_MAX", 100)
    log = ProcessLog(tmp_path / "part.log")
    with log.open() as file:
        for number in range(50):
            file.write(f"line {number:02}\n".encode())
            log.trim()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["part.log", "part.log.1"]
    text = (tmp_path / "part.log.1").read_text() + (tmp_path / "part.log").read_text()
    assert text.endswith("".join(f"line {number:02}\n" for number in range(38, 50)))
    assert all(path.stat().st_size <= 100 for path in tmp_path.iterdir())


def test_a_process_goes_on_writing_after_its_file_was_trimmed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(logs_module, "FILE_BYTES_MAX", 100)
    log = ProcessLog(tmp_path / "part.log")
    code = "head -c 300 /dev/zero | tr '\\0' x; echo; echo full; read _; echo after"
    with log.open() as file:
        process = subprocess.Popen(["sh", "-c", code], stdin=subprocess.PIPE, stdout=file)
    while log.last(1) != "full":
        pass
    log.trim()
    process.communicate(b"\n", timeout=SECONDS)
    assert (tmp_path / "part.log").read_text() == "after\n"
    assert (tmp_path / "part.log.1").stat().st_size == 100


def test_the_last_lines_are_found(tmp_path: Path) -> None:
    log = ProcessLog(tmp_path / "part.log")
    assert log.last(3) == ""
    with log.open() as file:
        file.write(b"one\ntwo\n\n  \nthree\r\nfour")
        assert log.last(3) == "two / three / four"
        assert log.last(1) == "four"
        file.write(b"\xff" * 10_000)
    assert len(log.last(1)) <= 2000


def test_a_log_that_cannot_be_written_is_ignored(tmp_path: Path) -> None:
    log = ProcessLog(tmp_path / "missing" / "part.log")
    with log.open() as file:
        file.write(b"said\n")
    log.trim()
    assert log.last(1) == ""
