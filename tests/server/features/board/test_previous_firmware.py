"""The firmware that is stored before an upload: without boot loader, and never replaced by its successor."""

from pathlib import Path

import pytest

from server.features.board.firmware_upload import read_progress
from server.features.board.previous_firmware import (
    BOOT_LOADER,
    HexFileError,
    read_program,
    store_if_other,
    write_program,
)

OLD, NEW = bytes(range(200)), b"\x0c\x94" * 300


@pytest.fixture
def built(tmp_path: Path) -> Path:
    write_program(NEW, tmp_path / "built.hex")
    return tmp_path / "built.hex"


def test_a_program_is_read_as_it_was_written(built: Path) -> None:
    assert read_program(built) == NEW


def test_what_was_read_is_stored_without_the_boot_loader(tmp_path: Path, built: Path) -> None:
    read = tmp_path / "read.hex"
    write_program(OLD.ljust(BOOT_LOADER, b"\xff") + b"\x11\x24" * 200, read)
    assert store_if_other(read, built, tmp_path / "previous.hex") == "other"
    assert read_program(tmp_path / "previous.hex") == OLD
    assert ":107E" not in (tmp_path / "previous.hex").read_text()


@pytest.mark.parametrize(
    ("program", "content"),
    [(NEW, "same"), (NEW.ljust(640, b"\xff") + OLD, "same"), (b"", "empty")],
    ids=["the same", "over a longer one", "an empty board"],
)
def test_an_older_firmware_is_not_replaced_by_the_new_one_or_by_none(
    tmp_path: Path, built: Path, program: bytes, content: str
) -> None:
    read, previous = tmp_path / "read.hex", tmp_path / "previous.hex"
    write_program(OLD, previous)
    write_program(program, read)
    assert store_if_other(read, built, previous) == content
    assert read_program(previous) == OLD


def test_a_damaged_file_is_refused_with_its_line(tmp_path: Path, built: Path) -> None:
    lines = built.read_text().split()
    lines[2] = lines[2][:-2] + "00"
    (tmp_path / "damaged.hex").write_text("\n".join(lines))
    with pytest.raises(HexFileError, match="damaged in line 3"):
        read_program(tmp_path / "damaged.hex")


@pytest.mark.parametrize(
    ("answer", "verified", "share"),
    [
        ("", True, 0.0),
        ("avrdude: writing\n\nWriting | " + 25 * "#", True, 0.25),
        ("Writing | " + 50 * "#" + " | 100% 3.4s\n\nReading | " + 25 * "#", True, 0.75),
        ("Reading | " + 25 * "#", False, 0.5),
        ("Reading | " + 50 * "#" + " | 100%", False, 1.0),
    ],
)
def test_the_progress_is_that_of_avrdude(answer: str, verified: bool, share: float) -> None:
    assert read_progress(answer, verified=verified) == pytest.approx(share)
