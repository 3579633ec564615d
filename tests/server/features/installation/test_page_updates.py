"""Releases that pages send: stored whole, handed over once, and refused where nothing may be updated."""

import asyncio
import json
import os
import time
from collections.abc import AsyncIterator
from functools import partial
from pathlib import Path

import pytest

from robot_runtime.errors import RefusedError
from server import VERSION
from server.features.installation import page_updates
from server.features.installation.page_updates import NOT_BEGUN, NOT_INSTALLED, PageUpdates
from server.features.installation.places import InstallPlaces
from server.features.installation.report import CUT_OFF, UpdateReport
from server.http.uploads import InvalidUploadError
from server.platform.disk_space import SPARE_BYTES, FileWriteError, free_bytes
from server.platform.settings import DataFolder

RELEASE = b"PK a release"


@pytest.fixture
def places(tmp_path: Path) -> InstallPlaces:
    """Of a computer on which this version is installed, and 0.1.0 was before."""
    result = InstallPlaces(tmp_path)
    for folder in (result.version(VERSION), result.version("0.1.0"), result.data, result.report.parent):
        folder.mkdir(parents=True)
    result.current.symlink_to(result.version(VERSION))
    result.previous.symlink_to(result.version("0.1.0"))
    return result


@pytest.fixture
def updates(places: InstallPlaces) -> PageUpdates:
    return PageUpdates(DataFolder(places.data), places)


async def pieces(*content: bytes) -> AsyncIterator[bytes]:
    for name in content:
        yield name


def send(updates: PageUpdates, *content: bytes, size: int | None = None) -> None:
    asyncio.run(updates.receive(pieces(*content), size))


def begin(updates: PageUpdates, *, recording: bool = False) -> None:
    asyncio.run(updates.begin(recording=recording))


def test_a_release_is_handed_over_whole_and_once(updates: PageUpdates, places: InstallPlaces) -> None:
    assert updates.state().model_dump(exclude={"time"}) == {
        "installed": True,
        "version": VERSION,
        "previous": "0.1.0",
        "refusal": "",
        "phase": "none",
        "text": "",
    }
    send(updates, RELEASE[:3], RELEASE[3:], size=len(RELEASE))
    assert not places.request.exists()
    begin(updates)
    assert places.requested.read_bytes() == RELEASE
    assert updates.state().phase == "asked"
    for again in (partial(send, updates, RELEASE), partial(begin, updates)):
        with pytest.raises(RefusedError, match="An update is running"):
            again()


def test_the_report_of_the_service_is_shown(updates: PageUpdates, places: InstallPlaces) -> None:
    report = UpdateReport(places.report)
    report.write("running", "The release is checked.")
    state = updates.state()
    assert (state.phase, state.text) == ("running", "The release is checked.")
    assert "An update is running" in state.refusal
    report.write("failed", "The signature is wrong.")
    state = updates.state()
    assert (state.phase, state.text, state.refusal) == ("failed", "The signature is wrong.", "")
    assert state.time is not None
    assert abs(state.time.timestamp() - time.time()) < 60


def test_an_update_whose_process_has_died_does_not_run_for_ever(
    updates: PageUpdates, places: InstallPlaces
) -> None:
    UpdateReport(places.report).write("running", "The release is checked.")
    text = json.loads(places.report.read_text())
    places.report.write_text(json.dumps(text | {"started": text["started"] - 1}))
    state = updates.state()
    assert (state.phase, state.text, state.refusal) == ("failed", CUT_OFF, "")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"phase": "done", "text": "", "time": "x", "pid": 1}'])
def test_a_damaged_report_is_none(updates: PageUpdates, places: InstallPlaces, text: str) -> None:
    places.report.write_text(text)
    assert updates.state().phase == "none"


def test_a_service_that_does_not_begin_is_told(updates: PageUpdates, places: InstallPlaces) -> None:
    send(updates, RELEASE)
    begin(updates)
    assert updates.state().text == ""
    before = time.time() - page_updates.BEGIN_SECONDS - 1
    os.utime(places.request, (before, before))
    assert updates.state().text == NOT_BEGUN


def test_without_an_installation_nothing_is_taken(places: InstallPlaces, tmp_path: Path) -> None:
    elsewhere = PageUpdates(DataFolder(tmp_path / "data"), places)
    places.current.unlink()
    for updates in (elsewhere, PageUpdates(DataFolder(places.data), places)):
        assert (updates.state().installed, updates.state().refusal) == (False, NOT_INSTALLED)
        with pytest.raises(RefusedError, match="not installed as a service"):
            send(updates, RELEASE)
        with pytest.raises(RefusedError, match="not installed as a service"):
            begin(updates)
    assert not places.request.parent.exists()


def test_what_cannot_be_begun_is_refused_and_asks_for_nothing(
    updates: PageUpdates, places: InstallPlaces
) -> None:
    with pytest.raises(RefusedError, match="No release was sent"):
        begin(updates)
    send(updates, RELEASE)
    with pytest.raises(RefusedError, match="is being recorded"):
        begin(updates, recording=True)
    assert not places.request.exists()


async def test_a_release_is_not_sent_twice_at_once(updates: PageUpdates) -> None:
    hanging = asyncio.Event()

    async def hang() -> AsyncIterator[bytes]:
        yield RELEASE
        await hanging.wait()

    first = asyncio.create_task(updates.receive(hang(), None))
    await asyncio.sleep(0)
    with pytest.raises(RefusedError, match="is being sent"):
        await updates.receive(pieces(RELEASE), None)
    with pytest.raises(RefusedError, match="is being sent"):
        await updates.begin(recording=False)
    hanging.set()
    await first
    await updates.begin(recording=False)


def test_what_is_too_large_leaves_nothing(
    updates: PageUpdates, places: InstallPlaces, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_updates, "RELEASE_BYTES", len(RELEASE) - 1)
    with pytest.raises(InvalidUploadError, match="too large"):
        send(updates, RELEASE)
    with pytest.raises(FileWriteError, match="Free some space"):
        send(updates, RELEASE, size=free_bytes(places.data) + 10 * SPARE_BYTES)
    assert list(places.requested.parent.iterdir()) == []


def test_the_rest_of_an_upload_is_removed_at_the_next_start(
    updates: PageUpdates, places: InstallPlaces
) -> None:
    part = places.requested.with_name(places.requested.name + ".part")
    send(updates, RELEASE)
    places.requested.rename(part)
    updates.recover()
    assert list(part.parent.iterdir()) == []


def test_a_server_that_is_not_the_installed_one_leaves_its_upload_alone(
    places: InstallPlaces, tmp_path: Path
) -> None:
    part = places.requested.with_name(places.requested.name + ".part")
    part.parent.mkdir()
    part.write_bytes(RELEASE)
    PageUpdates(DataFolder(tmp_path / "data"), places).recover()
    assert part.read_bytes() == RELEASE


def test_the_rest_of_an_upload_that_cannot_be_removed_hinders_no_start(
    updates: PageUpdates, places: InstallPlaces
) -> None:
    # As root every file can be removed: a folder in its place cannot.
    part = places.requested.with_name(places.requested.name + ".part")
    part.mkdir(parents=True)
    updates.recover()
    assert part.is_dir()
