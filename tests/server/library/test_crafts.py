"""A session knows the craft with which it was swum, and its exports and comparisons show it."""

import asyncio
import io
import json
import zipfile
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from sqlalchemy import update

from robot_runtime.contract.craft import Craft, craft_table, read_craft
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from server.analysis.differences import find_differences
from server.analysis.history import read_history
from server.analysis.samples import Samples
from server.features.exports.formats import check
from server.features.exports.imports import Imports
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.library.content import Recording, RecordingError
from server.library.listing import Listing
from server.platform.models import SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import STANDING_SECONDS
from server.recording.session import find_row
from tests.server.blocks import depth_block, state_block
from tests.server.features.doors.rig import rows_block, truth
from tests.server.features.exports.recordings import record
from tests.server.library.crafts import craft_block
from tests.server.recording.recorder_rig import RecorderRig

HEAVY: dict[str, Any] = {
    "mass": 3.9,
    "fin_positions": ((0.1, 0.06), (-0.1, 0.06), (-0.1, -0.06), (0.1, -0.06)),
}
TRUTH = rows_block("truth", 0, (100.0, truth((1, 2, 3), (1.0, 0.0, 0.0, 0.0))))
STATUS = Block.of(BY_NAME["status"], 1, 0, bytes(BY_NAME["status"].row_bytes))


def export(store: Store, session: int, format_: str) -> bytes:
    output = io.BytesIO()
    options = ExportOptions(format=format_)  # type: ignore[arg-type]
    check(options).write(store, ExportSelection(store, find_row(store, session), options), output)
    return output.getvalue()


def differences(store: Store, *sessions: int) -> dict[tuple[str, str], list[str]]:
    results = []
    for session in sessions:
        row = find_row(store, session)
        results.append((row, read_history(Recording(store, row), Samples())))
    return {
        (difference.group, difference.name): difference.values for difference in find_differences(results)
    }


def test_a_session_shows_its_craft_as_a_file_with_all_numbers(store: Store, settings: Settings) -> None:
    session = record(store, settings, [craft_block(0, **HEAVY), craft_block(1, time=110.0, **HEAVY)])
    shown = Listing(store).detail(session)
    assert shown.water == "simulated"
    (craft,) = shown.crafts
    assert (craft.time, craft.title, craft.origin) == (0.5, "Turtle 2", "weighed")
    read = read_craft(craft.file)
    assert (read.title, read.craft) == ("Turtle 2", Craft(**HEAVY))
    # What is the default's today may be another number tomorrow.
    assert "added_mass" in craft.file
    assert "added_mass" not in craft_table(read.craft)


def test_each_craft_of_a_session_is_shown_with_its_time(store: Store, settings: Settings) -> None:
    session = record(store, settings, [craft_block(0), craft_block(1, "Turtle 3", time=104.0, mass=2.0)])
    shown = Listing(store).detail(session).crafts
    assert [(mission.time, mission.title) for mission in shown] == [(0.5, "Turtle 2"), (4.5, "Turtle 3")]


@pytest.mark.parametrize(
    ("blocks", "water"),
    [
        ([STATUS], "real"),
        ([depth_block(0, 5), TRUTH], "simulated"),
        ([depth_block(0, 5)], "unknown"),
    ],
)
def test_a_session_without_a_craft_says_whether_its_water_was_real(
    store: Store, settings: Settings, blocks: list[Block], water: str
) -> None:
    shown = Listing(store).detail(record(store, settings, blocks))
    assert (shown.water, shown.crafts) == (water, [])


async def test_a_session_begins_with_the_craft_that_swims_and_not_with_one_that_has_left(
    store: Store, settings: Settings
) -> None:
    rig = RecorderRig(store, settings)

    rig.recorder.add(craft_block(4, time=45.0))
    for seconds in (0.0, STANDING_SECONDS + 1):
        rig.clock.forward(seconds)
        session = await rig.start()
        await rig.recorder.stop(session)
    first, second = (Listing(store).detail(session).crafts for session in (1, 2))
    assert [(mission.time, mission.title) for mission in first] == [(0.0, "Turtle 2")]
    assert second == []


def test_tables_and_mcap_have_the_craft_file(store: Store, settings: Settings) -> None:
    session = record(
        store, settings, [TRUTH, craft_block(0), craft_block(1, "Turtle 3", time=104.0, mass=2.0)]
    )
    archive = zipfile.ZipFile(io.BytesIO(export(store, session, "csv")))
    assert read_craft(archive.read("craft.toml").decode()).title == "Turtle 2"
    assert read_craft(archive.read("craft-2.toml").decode()).craft.mass == 2.0
    assert "Turtle 3" in archive.read("craft.csv").decode()
    reader = make_reader(io.BytesIO(export(store, session, "mcap")))
    attached = {attachment.name: attachment.data.decode() for attachment in reader.iter_attachments()}
    assert read_craft(attached["craft-2.toml"]).title == "Turtle 3"
    about = {entry.name: entry.metadata for entry in reader.iter_metadata()}
    assert about["craft"] == {"water": "simulated", "title": "Turtle 2, then Turtle 3"}
    titles = [json.loads(message.data)["title"] for _, _, message in reader.iter_messages(topics=["/craft"])]
    assert titles == ["Turtle 2", "Turtle 3"]


def test_an_archive_takes_the_craft_along(store: Store, settings: Settings, tmp_path: Path) -> None:
    session = record(store, settings, [craft_block(0, **HEAVY)])
    file = tmp_path / "dive.zip"
    file.write_bytes(export(store, session, "archive"))
    before = Listing(store).detail(session).crafts
    asyncio.run(store.execute(update(SessionRow).values(identifier="0" * 32)))
    imported = asyncio.run(Imports(settings.data, store).take(file))
    assert Listing(store).detail(imported).crafts == before


def test_sessions_that_differ_in_their_craft_are_compared_by_its_numbers(
    store: Store, settings: Settings
) -> None:
    number = record(store, settings, [craft_block(0), state_block(0)])
    other = record(store, settings, [craft_block(0, "Turtle 3", mass=2.0), state_block(0)])
    old = record(store, settings, [TRUTH, state_block(0)])
    real = record(store, settings, [STATUS, state_block(0)])
    assert differences(store, number, other) == {
        ("Session", "Craft"): ["Turtle 2", "Turtle 3"],
        ("Craft", "mass"): ["3", "2"],
    }
    # Where one is not known there is nothing to compare, and not all numbers differ.
    assert differences(store, number, old) == {("Session", "Craft"): ["Turtle 2", "not recorded"]}
    assert differences(store, number, real) == {("Session", "Craft"): ["Turtle 2", "real robot"]}
    assert differences(store, number, number) == {}


def test_a_damaged_craft_is_said_in_words(store: Store, settings: Settings) -> None:
    block = craft_block(0)
    payload = block.payload.replace(b'"title"', b'"tidle"')
    session = record(store, settings, [Block.of(block.topic, 1, 0, payload)])
    with pytest.raises(RecordingError, match="its content is not as expected"):
        Listing(store).detail(session)
