"""Updates into a folder: whole, refused, of versions that do not work, and cut off at every effect."""

import errno
import os
import shutil
import signal
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from server.features.installation import installer, updater
from server.features.installation.effects import Effects
from server.features.installation.environments import WHEELS
from server.features.installation.release import SUMS, read_release
from server.features.installation.report import UpdateReport, hold
from server.features.installation.updater import Updater
from server.platform.pidfile import pid_file
from server.platform.settings import DataFolder, SetupError
from tests.server.features.installation.computer import PowerCutError, place_release, place_version
from tests.server.features.installation.signing import make_keys, sign
from tests.server.features.installation.updatable import UpdatableComputer

DIVES = "ten dives"


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(updater, "HEALTHY_SECONDS", 0.02)
    monkeypatch.setattr(installer, "LOOK_SECONDS", 0.005)


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("keys")
    make_keys(folder)
    return folder


@pytest.fixture
def release(tmp_path: Path, keys: Path) -> Path:
    return signed(tmp_path / "release", keys, "2.0.0")


def signed(folder: Path, keys: Path, version: str) -> Path:
    place_release(folder, version)
    sign(folder, keys / "secret.pem")
    return folder


def installed(root: Path, keys: Path) -> UpdatableComputer:
    """A computer on which 1.0.0 runs, with dives; 2.0.0 has another schema and other firmware."""
    computer = UpdatableComputer(root)
    computer.schemas, computer.firmware = {"1.0.0": 1, "2.0.0": 2}, {"1.0.0": "old", "2.0.0": "new"}
    folder = place_release(root.parent / "first", "1.0.0")
    shutil.copy(keys / "release.pem", folder)
    computer.installer(computer.effects()).install(read_release(folder))
    computer.database.write_text(f"1 {DIVES}")
    computer.board = "old"
    return computer


def update(computer: UpdatableComputer, path: Path, cut: int = -1) -> str:
    return Updater(computer.places, computer.effects(cut)).update(path)


def roll_back(computer: UpdatableComputer) -> str:
    return Updater(computer.places, computer.effects()).roll_back()


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
            words = f"cut {cuts}: {computer.lines[-1]}"
            computer.boot()
            ends.add(computer.running)
            assert computer.running in ({"1.0.0"} if sick else {"1.0.0", "2.0.0"}), words
            assert computer.database.read_text() == f"{computer.schemas[computer.running]} {DIVES}", words
            assert computer.board == computer.firmware[computer.running], words
            computer.sick.clear()
            if computer.running == "1.0.0":
                update(computer, release)
            assert (computer.running, computer.database.read_text()) == ("2.0.0", f"2 {DIVES}"), words
            cuts += 1
        except SetupError:
            assert sick
            break
        else:
            assert not sick
            break
    assert cuts > 12
    assert ends == ({"1.0.0"} if sick else {"1.0.0", "2.0.0"})


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
    "a recording": (recording, "Stop it first"),
    "a new fault": (without_a_library, r"OpenCV cannot be loaded\. Nothing was changed"),
    "another architecture": (for_another_computer, "no wheel of numpy"),
    "the version in use": (in_use, "in use already"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_done_is_refused_in_one_line_and_changes_nothing(
    tmp_path: Path, keys: Path, release: Path, name: str
) -> None:
    computer = installed(tmp_path / "pi", keys)
    prepare, words = REFUSED[name]
    prepare(release, computer)
    before = computer.tree()
    with pytest.raises(SetupError, match=words) as caught:
        update(computer, release)
    assert "\n" not in str(caught.value)
    shutil.rmtree(computer.places.version("2.0.0"), ignore_errors=name != "the version in use")
    if name == "the version in use":
        before = {one: text for one, text in before.items() if "versions/2.0.0" not in one}
    assert computer.tree() == before


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


@pytest.mark.parametrize(
    ("content", "words"), [(b"PK\3\4 cut", "no whole ZIP file"), (b"", "no whole ZIP file")]
)
def test_a_cut_zip_file_is_refused(tmp_path: Path, keys: Path, content: bytes, words: str) -> None:
    computer = installed(tmp_path / "pi", keys)
    path = tmp_path / "release.zip"
    path.write_bytes(content)
    before = computer.tree()
    with pytest.raises(SetupError, match=words):
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
    with pytest.raises(SetupError, match=r"100 MB are free, and 2\.0\.0 needs 700 MB"):
        update(computer, release)


def test_the_way_back_keeps_what_the_older_version_can_read(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.schemas["2.0.0"] = 1
    update(computer, release)
    computer.database.write_text("1 eleven dives")
    assert roll_back(computer) == "1.0.0"
    assert (computer.running, computer.board) == ("1.0.0", "old")
    assert computer.database.read_text() == "1 eleven dives"
    with pytest.raises(SetupError, match="no version to go back to"):
        roll_back(computer)


def test_the_way_back_takes_the_copy_where_the_older_version_cannot_read_the_database(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    update(computer, release)
    roll_back(computer)
    assert (computer.running, computer.database.read_text()) == ("1.0.0", f"1 {DIVES}")


def test_cut_off_at_any_effect_the_way_back_is_gone_to_its_end(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    cuts = 0
    while True:
        computer = installed(tmp_path / str(cuts), keys)
        update(computer, release)
        try:
            Updater(computer.places, computer.effects(cuts)).roll_back()
        except PowerCutError:
            words = f"cut {cuts}: {computer.lines[-1]}"
            computer.boot()
            # Before the journal is written, nothing has happened.
            assert computer.running == ("1.0.0" if cuts else "2.0.0"), words
            assert computer.database.read_text() == f"{computer.schemas[computer.running]} {DIVES}", words
            assert computer.board == computer.firmware[computer.running], words
            assert not computer.places.journal.exists(), words
            cuts += 1
        else:
            break
    assert cuts > 6
    assert computer.running == "1.0.0"


def test_a_failed_update_leaves_the_way_back_to_the_version_before(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    update(computer, release)
    computer.schemas["3.0.0"] = 2
    computer.sick.add("3.0.0")
    with pytest.raises(SetupError, match="not healthy"):
        update(computer, signed(tmp_path / "third", keys, "3.0.0"))
    assert computer.running == "2.0.0"
    assert roll_back(computer) == "1.0.0"
    assert (computer.running, computer.board) == ("1.0.0", "old")


def test_without_a_fitting_copy_there_is_no_way_back(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    update(computer, release)
    computer.copy(1).unlink()
    with pytest.raises(SetupError, match=r"no copy of it fits\. Nothing was changed"):
        roll_back(computer)
    assert (computer.running, computer.database.read_text()) == ("2.0.0", f"2 {DIVES}")


def test_an_armed_robot_keeps_its_version(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    update(computer, release)
    computer.armed = True
    with pytest.raises(SetupError, match="Disarm it first"):
        roll_back(computer)


def test_without_a_runtime_an_update_mends_what_cannot_look_at_itself(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    computer.broken["current/bin/python -I -m server.features.installation.survey"] = "Killed"

    def mend(words: str) -> None:
        if words.startswith(f"link {computer.places.current} "):
            computer.broken.clear()

    effects = Effects(computer.lines.append, run=computer.run, before=mend)
    assert Updater(computer.places, effects).update(release) == "2.0.0"


def test_a_version_that_swims_is_not_put_back_after_an_update_that_was_ended(
    tmp_path: Path, keys: Path, release: Path
) -> None:
    computer = installed(tmp_path / "pi", keys)
    end_before_it_is_healthy(computer, release)
    computer.armed = True
    for change in (partial(update, computer, release), partial(roll_back, computer)):
        with pytest.raises(SetupError, match="Disarm it first"):
            change()
    assert computer.running == "2.0.0"


@pytest.mark.parametrize("older", [False, True])
def test_the_way_back_from_an_update_that_was_ended_goes_back_once(
    tmp_path: Path, keys: Path, release: Path, older: bool
) -> None:
    computer = installed(tmp_path / "pi", keys)
    if older:
        computer.places.previous.symlink_to(place_version(computer, "0.9.0"))
    end_before_it_is_healthy(computer, release)
    assert roll_back(computer) == "1.0.0"
    assert (computer.running, computer.database.read_text()) == ("1.0.0", f"1 {DIVES}")
    assert report_of(computer) == ("done", "µ-CAT 1.0.0 is in use again.")


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


def end_before_it_is_healthy(computer: UpdatableComputer, release: Path) -> None:
    """Begin an update; it is ended after the switch, when its version runs already."""

    def end(words: str) -> None:
        if words.startswith(f"write {computer.places.last_switch}"):
            raise PowerCutError

    with pytest.raises(PowerCutError):
        Updater(computer.places, Effects(computer.lines.append, run=computer.run, before=end)).update(release)
    assert computer.running == read_release(release).version
    assert computer.places.journal.exists()


def test_two_versions_are_kept(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    update(computer, release)
    computer.schemas["3.0.0"] = 2
    update(computer, signed(tmp_path / "third", keys, "3.0.0"))
    assert sorted(one.name for one in computer.places.versions.iterdir()) == ["2.0.0", "3.0.0"]


def test_updates_that_come_to_nothing_do_not_fill_the_card(tmp_path: Path, keys: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    for number in range(2, 5):
        version = f"{number}.0.0"
        computer.wrong[version] = "OpenCV cannot be loaded."
        folder = signed(tmp_path / version, keys, version)
        with pytest.raises(SetupError, match="OpenCV"):
            update(computer, folder)
        assert {one.name for one in computer.places.versions.iterdir()} == {"1.0.0", version}


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


def report_of(computer: UpdatableComputer) -> tuple[str, str]:
    report = UpdateReport(computer.places.report).read()
    assert report is not None
    return report.phase, report.text


def test_the_report_tells_how_it_goes_and_how_it_ended(tmp_path: Path, keys: Path, release: Path) -> None:
    computer = installed(tmp_path / "pi", keys)
    told: list[str] = []

    def look(_: str) -> None:
        if computer.places.report.exists() and (words := report_of(computer)[1]) not in told[-1:]:
            told.append(words)

    Updater(computer.places, Effects(look, run=computer.run, before=look)).update(release)
    assert told == [
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
    words = "The update to 2.0.0 was cut off: 1.0.0 is in use again."
    assert report_of(computer) == ("failed", words)
    computer.places.report.unlink()
    computer.boot()
    assert not computer.places.report.exists()
