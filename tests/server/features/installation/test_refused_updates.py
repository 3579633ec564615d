"""Updates that are refused, and change nothing."""

import os
import shutil
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from server.features.installation import updater
from server.features.installation.release import SUMS
from server.features.installation.report import UpdateReport, hold
from server.platform.pidfile import pid_file
from server.platform.settings import DataFolder, SetupError
from tests.server.features.installation.updatable import (
    UpdatableComputer,
    installed,
    report_of,
    roll_back,
    update,
)


def unsigned(folder: Path, _: UpdatableComputer) -> None:
    (folder / SUMS).write_text((folder / SUMS).read_text() + "\n")


def armed(_: Path, computer: UpdatableComputer) -> None:
    computer.armed = True


def silent(_: Path, computer: UpdatableComputer) -> None:
    computer.silent = True
    run_runtime(computer)


def without_a_survey(_: Path, computer: UpdatableComputer) -> None:
    computer.broken["current/bin/python -I -m server.features.installation.survey"] = "Killed"
    run_runtime(computer)


def run_runtime(computer: UpdatableComputer) -> None:
    """This process is its runtime."""
    run = DataFolder(computer.places.data).run
    run.mkdir()
    pid_file(run, "runtime").write(os.getpid(), "")


def recording(_: Path, computer: UpdatableComputer) -> None:
    computer.recording = True


def without_a_library(_: Path, computer: UpdatableComputer) -> None:
    computer.wrong["2.0.0"] = "OpenCV cannot be loaded."


def for_another_computer(_: Path, computer: UpdatableComputer) -> None:
    computer.broken[" install --quiet"] = "ERROR: No matching distribution found for numpy"


def in_use(_: Path, computer: UpdatableComputer) -> None:
    computer.places.current.unlink()
    shutil.copytree(computer.places.version("1.0.0"), computer.places.version("2.0.0"))
    computer.places.current.symlink_to(computer.places.version("2.0.0"))


REFUSED: dict[str, tuple[Callable[[Path, UpdatableComputer], None], str]] = {
    "changed checksums": (unsigned, "signature .* is wrong"),
    "an armed robot": (armed, "Disarm it first"),
    "a server that does not answer": (silent, "may be armed: No server works on it"),
    "a version that cannot look at itself": (without_a_survey, "may be armed: runuser failed .* Killed"),
    "a recording": (recording, "Stop it first .mucat record stop."),
    "a new fault": (without_a_library, r"OpenCV cannot be loaded\. Nothing was changed"),
    "another architecture": (for_another_computer, "no wheel of numpy"),
    "the version in use": (in_use, "in use already"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_done_is_refused_in_one_line_and_changes_nothing(
    tmp_path: Path, keys: Path, release: Path, name: str
) -> None:
    computer = installed(tmp_path / "pi", keys)
    prepare, message = REFUSED[name]
    prepare(release, computer)
    before = computer.tree()
    with pytest.raises(SetupError, match=message) as caught:
        update(computer, release)
    assert "\n" not in str(caught.value)
    shutil.rmtree(computer.places.version("2.0.0"), ignore_errors=name != "the version in use")
    if name == "the version in use":
        before = {path: text for path, text in before.items() if "versions/2.0.0" not in path}
    assert computer.tree() == before


@pytest.mark.parametrize(
    ("content", "message"), [(b"PK\3\4 cut", "no whole ZIP file"), (b"", "no whole ZIP file")]
)
def test_a_cut_zip_file_is_refused(tmp_path: Path, keys: Path, content: bytes, message: str) -> None:
    computer = installed(tmp_path / "pi", keys)
    path = tmp_path / "release.zip"
    path.write_bytes(content)
    before = computer.tree()
    with pytest.raises(SetupError, match=message):
        update(computer, path)
    assert computer.tree() == before


def test_a_damaged_zip_file_is_refused(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    path, name = tmp_path / "release.zip", "mucat-2.0.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(release / name, name)
    damaged = bytearray(path.read_bytes())
    with zipfile.ZipFile(path) as archive:
        begin = len(archive.infolist()[0].FileHeader())
    damaged[begin : begin + 20] = b"\xff" * 20
    path.write_bytes(damaged)
    with pytest.raises(SetupError, match="no whole ZIP file") as caught:
        update(computer, path)
    assert "\n" not in str(caught.value)


def test_an_archive_that_unpacks_to_more_than_a_release_is_refused(
    tmp_path: Path, keys: Path, release: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computer = installed(tmp_path / "pi", keys)
    path = Path(shutil.make_archive(str(tmp_path / "big"), "zip", release))
    monkeypatch.setattr(updater, "RELEASE_BYTES", 100)
    with pytest.raises(SetupError, match="it is no release"):
        update(computer, path)


def test_a_full_disk_is_refused(
    tmp_path: Path, keys: Path, release: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computer = installed(tmp_path / "pi", keys)
    monkeypatch.setattr(updater, "free_bytes", lambda _: 10**8)
    with pytest.raises(SetupError, match=r"100 MB are free, and 2\.0\.0 needs 1100 MB"):
        update(computer, release)


def test_the_installation_is_changed_by_one_at_a_time(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    UpdateReport(computer.places.report).write("running", "Another update.")
    before = computer.tree()
    with hold(computer.places.lock):
        for change in (partial(update, computer, release), partial(roll_back, computer)):
            with pytest.raises(SetupError, match="is being changed already"):
                change()
    assert computer.tree() == before
    assert report_of(computer) == ("running", "Another update.")
    assert update(computer, release) == "2.0.0"
