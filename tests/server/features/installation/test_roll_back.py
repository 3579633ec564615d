"""The way back to the version before."""

from functools import partial
from pathlib import Path

import pytest

from server.features.installation.effects import Effects
from server.features.installation.release import read_release
from server.features.installation.updater import Updater
from server.platform.settings import SetupError
from tests.server.features.installation.computer import PowerCutError, place_version
from tests.server.features.installation.updatable import (
    DIVES,
    UpdatableComputer,
    installed,
    report_of,
    roll_back,
    signed,
    update,
)


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
            text = f"cut {cuts}: {computer.lines[-1]}"
            computer.boot()
            # Before the journal is written, nothing has happened.
            assert computer.running == ("1.0.0" if cuts else "2.0.0"), text
            assert computer.database.read_text() == f"{computer.schemas[computer.running]} {DIVES}", text
            assert computer.board == computer.firmware[computer.running], text
            assert not computer.places.journal.exists(), text
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


def end_before_it_is_healthy(computer: UpdatableComputer, release: Path) -> None:
    """Begin an update; it is ended after the switch, when its version runs already."""

    def end(message: str) -> None:
        if message.startswith(f"write {computer.places.last_switch}"):
            raise PowerCutError

    with pytest.raises(PowerCutError):
        Updater(computer.places, Effects(computer.lines.append, run=computer.run, before=end)).update(release)
    assert computer.running == read_release(release).version
    assert computer.places.journal.exists()
