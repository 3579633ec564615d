"""Updates into a folder: whole, of versions that do not work, and cut off at every effect."""

import errno
import os
import signal
import zipfile
from pathlib import Path

import pytest

from server.features.installation.effects import Effects
from server.features.installation.environments import WHEELS
from server.features.installation.release import read_release
from server.features.installation.updater import Updater
from server.platform.settings import SetupError
from tests.server.features.installation.computer import PowerCutError, place_release, place_version
from tests.server.features.installation.signing import sign
from tests.server.features.installation.updatable import (
    DIVES,
    installed,
    report_of,
    roll_back,
    signed,
    update,
)


def test_an_update_is_whole(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    assert update(computer, release) == "2.0.0"
    places = computer.places
    assert (computer.running, computer.board) == ("2.0.0", "new")
    assert (places.version_of(places.current), places.version_of(places.previous)) == ("2.0.0", "1.0.0")
    assert computer.database.read_text() == f"2 {DIVES}"
    assert (places.units / "mucat.service").read_text() == "mucat.service of 2.0.0"
    assert not places.journal.exists()
    assert not places.incoming.exists()


def test_a_zip_file_is_a_release_too(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    with zipfile.ZipFile(tmp_path / "any.zip", "w") as archive:
        for file in release.iterdir():
            archive.write(file, f"mucat-2.0.0/{file.name}")
        archive.writestr("../../../evil.sh", "rm")
    update(computer, tmp_path / "any.zip")
    assert computer.running == "2.0.0"
    assert not list(tmp_path.rglob("evil.sh"))


def test_without_new_firmware_the_board_is_left_alone(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.firmware["2.0.0"] = "old"
    update(computer, release)
    assert not [line for line in computer.commands if line.endswith(" upload")]


@pytest.mark.parametrize("schema", [1, 2])
def test_a_version_that_does_not_work_is_taken_back(
    tmp_path: Path, keys: Path, release: Path, schema: int
) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.schemas["2.0.0"] = schema
    computer.sick.add("2.0.0")
    with pytest.raises(SetupError, match=r"not healthy.* 1\.0\.0 is in use again, with its database"):
        update(computer, release)
    assert (computer.running, computer.board) == ("1.0.0", "old")
    assert computer.database.read_text() == f"1 {DIVES}"
    assert (computer.places.units / "mucat.service").read_text() == "mucat.service of 1.0.0"
    assert not computer.places.journal.exists()


def test_a_board_that_does_not_take_the_firmware_takes_the_update_back(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.broken["2.0.0/bin/mucat upload"] = "The board does not answer."
    with pytest.raises(SetupError, match="The board does not answer"):
        update(computer, release)
    assert (computer.running, computer.board) == ("1.0.0", "old")


@pytest.mark.parametrize("sick", [False, True])
def test_cut_off_at_any_effect_one_version_runs_with_all_dives_and_it_can_be_done_again(
    tmp_path: Path, keys: Path, release: Path, sick: bool
) -> None:
    cuts, ends = 0, set()
    while True:
        computer = installed(tmp_path / str(cuts), keys)
        computer.sick = {"2.0.0"} if sick else set()
        # It is removed when the update is over.
        computer.places.previous.symlink_to(place_version(computer, "0.9.0"))
        try:
            update(computer, release, cuts)
        except PowerCutError:
            text = f"cut {cuts}: {computer.lines[-1]}"
            computer.boot()
            ends.add(computer.running)
            assert computer.running in ({"1.0.0"} if sick else {"1.0.0", "2.0.0"}), text
            assert computer.database.read_text() == f"{computer.schemas[computer.running]} {DIVES}", text
            assert computer.board == computer.firmware[computer.running], text
            computer.sick.clear()
            if computer.running == "1.0.0":
                update(computer, release)
            assert (computer.running, computer.database.read_text()) == ("2.0.0", f"2 {DIVES}"), text
            cuts += 1
        except SetupError:
            assert sick
            break
        else:
            assert not sick
            break
    assert cuts > 12
    assert ends == ({"1.0.0"} if sick else {"1.0.0", "2.0.0"})


def test_a_known_fault_of_the_computer_does_not_hinder_an_update(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.wrong = {"1.0.0": "The disk is slow.", "2.0.0": "The disk is slow."}
    assert update(computer, release) == "2.0.0"


def test_old_faults_do_not_hinder_the_update_of_a_doctor_that_cannot_be_asked(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.wrong = {"1.0.0": "The disk is slow.", "2.0.0": "The disk is slow."}
    computer.broken["current/bin/mucat doctor"] = "It takes more than 120 s."
    assert update(computer, release) == "2.0.0"


def test_a_corrected_release_of_the_same_version_is_built_anew(tmp_path: Path, keys: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.wrong["2.0.0"] = "OpenCV cannot be loaded."
    with pytest.raises(SetupError, match="OpenCV"):
        update(computer, signed(tmp_path / "first", keys, "2.0.0"))
    computer.wrong.clear()
    corrected = place_release(tmp_path / "corrected", "2.0.0")
    wheel = read_release(corrected).wheel
    wheel.write_text("corrected")
    sign(corrected, keys / "secret.pem")
    assert update(computer, corrected) == "2.0.0"
    assert (computer.places.current / WHEELS / wheel.name).read_text() == "corrected"


def test_without_a_runtime_an_update_mends_what_cannot_look_at_itself(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.broken["current/bin/python -I -m server.features.installation.survey"] = "Killed"

    def mend(message: str) -> None:
        if message.startswith(f"link {computer.places.current} "):
            computer.broken.clear()

    effects = Effects(computer.lines.append, run=computer.run, before=mend)
    assert Updater(computer.places, effects).update(release) == "2.0.0"


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGINT, signal.SIGTERM])
def test_neither_a_lost_session_nor_ctrl_c_ends_an_update_between_two_versions(
    tmp_path: Path, keys: Path, release: Path, number: signal.Signals
) -> None:
    class EndedError(Exception):
        """The process is ended."""

    def end(*_: object) -> None:
        raise EndedError

    def interrupt(_: str) -> None:
        if computer.places.journal.exists():
            signal.raise_signal(number)

    computer = installed(tmp_path / "pi", keys)
    updater = Updater(computer.places, Effects(computer.lines.append, run=computer.run, before=interrupt))
    before = signal.signal(number, end)
    try:
        assert updater.update(release) == "2.0.0"
        assert computer.running == "2.0.0"
        assert updater.roll_back() == "1.0.0"
        assert computer.running == "1.0.0"
        with pytest.raises(EndedError):
            signal.raise_signal(number)
    finally:
        signal.signal(number, before)


def test_an_update_whose_terminal_is_gone_goes_on(tmp_path: Path, keys: Path, release: Path) -> None:
    def say(_: str) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    computer = installed(tmp_path / "pi", keys)
    assert Updater(computer.places, Effects(say, run=computer.run)).update(release) == "2.0.0"


def test_two_versions_are_kept(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    update(computer, release)
    computer.schemas["3.0.0"] = 2
    update(computer, signed(tmp_path / "third", keys, "3.0.0"))
    assert sorted(file.name for file in computer.places.versions.iterdir()) == ["2.0.0", "3.0.0"]


def test_updates_that_come_to_nothing_do_not_fill_the_card(tmp_path: Path, keys: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    for number in range(2, 5):
        version = f"{number}.0.0"
        computer.wrong[version] = "OpenCV cannot be loaded."
        folder = signed(tmp_path / version, keys, version)
        with pytest.raises(SetupError, match="OpenCV"):
            update(computer, folder)
        assert {file.name for file in computer.places.versions.iterdir()} == {"1.0.0", version}


def test_the_report_tells_how_it_goes_and_how_it_ended(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    notices: list[str] = []

    def look(_: str) -> None:
        if computer.places.report.exists() and (text := report_of(computer)[1]) not in notices[-1:]:
            notices.append(text)

    Updater(computer.places, Effects(look, run=computer.run, before=look)).update(release)
    assert notices == [
        "The release is checked.",
        "µ-CAT 2.0.0 is built beside 1.0.0. The robot can be used meanwhile.",
        "The doctor of 2.0.0 looks at this computer.",
        "1.0.0 is stopped, and 2.0.0 started. It must be healthy within a minute.",
    ]
    assert report_of(computer) == ("done", "µ-CAT 2.0.0 is in use.")
    assert roll_back(computer) == "1.0.0"
    assert report_of(computer) == ("done", "µ-CAT 1.0.0 is in use again.")
    computer.sick.add("2.0.0")
    with pytest.raises(SetupError) as caught:
        update(computer, release)
    assert report_of(computer) == ("failed", str(caught.value))


def test_the_start_after_a_power_cut_reports_the_way_back(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    for cut in range(30):
        with pytest.raises(PowerCutError):
            update(computer, release, cut)
        if computer.places.journal.exists():
            break
    computer.places.report.unlink()
    computer.boot()
    text = "The update to 2.0.0 was cut off: 1.0.0 is in use again."
    assert report_of(computer) == ("failed", text)
    computer.places.report.unlink()
    computer.boot()
    assert not computer.places.report.exists()
