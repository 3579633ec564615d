"""A release: its wheel, its checksums and its signature, and everything that is wrong with others."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from server.features.installation.release import SIGNATURE, SUMS, check_signature, check_sums, read_release
from server.platform.settings import SetupError
from tests.server.features.installation.computer import place_release
from tests.server.features.installation.signing import make_keys, sign


@pytest.fixture
def signed(tmp_path: Path) -> Path:
    folder = place_release(tmp_path / "release")
    make_keys(tmp_path)
    sign(folder, tmp_path / "secret.pem")
    return folder


def test_a_signed_release_is_accepted(signed: Path, tmp_path: Path) -> None:
    release = read_release(signed)
    assert (release.version, release.folder) == ("1.0.0", signed)
    check_signature(release, tmp_path / "release.pem")
    assert read_release(release.wheel) == release


def cut(folder: Path) -> None:
    wheel = read_release(folder).wheel
    wheel.write_bytes(wheel.read_bytes()[:-3])


def sign_by_another(folder: Path) -> None:
    path = folder.parent / "other"
    path.mkdir()
    make_keys(path)
    sign(folder, path / "secret.pem")


def swap_sums(folder: Path) -> None:
    text = (folder / SUMS).read_text()
    (folder / SUMS).write_text(text.replace("numpy", "nunpy"))


FAULTS: dict[str, tuple[Callable[[Path], object], str]] = {
    "a cut download": (cut, "is damaged"),
    "a missing wheel": (lambda folder: next(folder.glob("numpy*")).unlink(), "numpy.* is missing"),
    "another's signature": (sign_by_another, "signature .* is wrong"),
    "changed checksums": (swap_sums, "signature .* is wrong"),
    "no signature": (lambda folder: (folder / SIGNATURE).unlink(), "is not signed"),
    "no checksums": (lambda folder: (folder / SUMS).unlink(), "is not signed"),
    "an empty signature": (lambda folder: (folder / SIGNATURE).write_bytes(b""), "signature .* is wrong"),
    "one more wheel": (
        lambda folder: (folder / "pip-99-py3-none-any.whl").touch(),
        "not among its checksums",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_release_with_a_fault_is_refused_in_one_line(fault: str, signed: Path, tmp_path: Path) -> None:
    spoil, text = FAULTS[fault]
    spoil(signed)
    with pytest.raises(SetupError, match=text) as caught:
        check_signature(read_release(signed), tmp_path / "release.pem")
    assert "\n" not in str(caught.value)


def test_without_a_key_nothing_is_accepted(signed: Path, tmp_path: Path) -> None:
    with pytest.raises(SetupError, match="There is no key"):
        check_signature(read_release(signed), tmp_path / "nowhere.pem")


@pytest.mark.parametrize("name", ["../mucat-1.whl", "/etc/passwd", "a b.whl", ".hidden.whl"])
def test_checksums_name_files_of_the_folder_alone(name: str, signed: Path) -> None:
    with (signed / SUMS).open("a") as file:
        file.write(f"{'0' * 64}  {name}\n")
    check_sums(read_release(signed))  # such a line is none


@pytest.mark.parametrize(
    "names", [[], ["mucat-1.0-py3-none-any.whl", "mucat-1.1-py3-none-any.whl"], ["mucat-x.whl"]]
)
def test_a_folder_without_one_wheel_is_refused(names: list[str], tmp_path: Path) -> None:
    for name in names:
        (tmp_path / name).touch()
    with pytest.raises(SetupError, match="must hold one wheel"):
        read_release(tmp_path)


def test_a_path_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SetupError, match="There is no"):
        read_release(tmp_path / "nowhere")


def test_openssl_made_the_keys(tmp_path: Path) -> None:
    make_keys(tmp_path)
    shown = subprocess.run(
        ["openssl", "pkey", "-pubin", "-in", str(tmp_path / "release.pem"), "-text", "-noout"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert "ED25519" in shown.upper()
