"""Packages on a computer that lacks the programs that build them."""

from collections.abc import Callable
from pathlib import Path

import pytest

from packages.architectures import PackagingError
from packages.mirror import find_mirror
from packages.signing import make_key, write_public_key
from packages.wheels import build_mucat


@pytest.fixture
def bare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, which is all that is searched for programs."""
    folder = tmp_path / "bare"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))
    return folder


NEEDED: dict[str, Callable[[Path], object]] = {
    "openssl": lambda folder: write_public_key(folder / "secret.pem", folder / "release.pem"),
    "apt-get": lambda _: find_mirror(),
}


@pytest.mark.parametrize("program", NEEDED)
def test_a_missing_program_is_named(bare: Path, program: str) -> None:
    with pytest.raises(PackagingError, match=program):
        NEEDED[program](bare)


def test_a_missing_firmware_is_named(bare: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("packages.wheels.BAUDS", (31_250,))
    with pytest.raises(PackagingError, match="no firmware for 31250 baud"):
        build_mucat(bare)


def test_a_key_that_could_not_be_made_is_made_the_next_time(
    bare: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    secret = bare / "secret.pem"
    with pytest.raises(PackagingError):
        make_key(secret)
    assert not secret.exists()
    monkeypatch.undo()
    make_key(secret)
    assert secret.stat().st_mode & 0o777 == 0o600
    assert "PRIVATE KEY" in secret.read_text()
