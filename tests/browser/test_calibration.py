"""Calibration on the System page: measure the gyroscope, save, restore, and refusals in words."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from robot_runtime.contract.calibration import EMULATED
from tests.browser.driving import hold_to_arm
from tests.browser.people import somebody
from tests.stack import Stack


@pytest.fixture(autouse=True)
def _emulated(stack: Stack) -> Iterator[None]:
    """The emulated board's own calibration, before and after: a bring-up measures anew."""
    _calibrate(stack)
    yield
    _calibrate(stack)


def _calibrate(stack: Stack) -> None:
    stack.api.post("/robot/stop").raise_for_status()
    values = {name: getattr(EMULATED, name) for name in EMULATED.__dataclass_fields__}
    end = time.monotonic() + 10
    # The board says that it is disarmed with its next status.
    while (answer := stack.api.post("/robot/commands/calibrate", json={"values": values})).is_error:
        assert time.monotonic() < end, answer.text
        time.sleep(0.05)


def opened(page: Page, stack: Stack) -> Locator:
    page.goto(f"{stack.url}/#/system")
    panel = page.get_by_role("region", name="Calibration", exact=True)
    expect(panel.get_by_text("Calibrated: all seven steps are done.")).to_be_visible()
    return panel


def saved(page: Page, panel: Locator) -> tuple[str, dict[str, Any]]:
    """Name and contents of the file that the panel saves."""
    with page.expect_download() as download:
        panel.get_by_role("button", name="Save to a file").click()
    return download.value.suggested_filename, json.loads(download.value.path().read_text())


def choose(panel: Locator, path: Path, values: object) -> None:
    path.write_text(json.dumps(values))
    panel.get_by_label("Calibration file").set_input_files(path)


def test_the_gyroscope_is_measured_saved_and_restored(any_page: Page, stack: Stack, tmp_path: Path) -> None:
    page, panel = any_page, opened(any_page, stack)
    name, before = saved(page, panel)
    assert name == "turtle.calibration.json"
    assert (before["fin_zeros"], before["gyro_bias"]) == (list(EMULATED.fin_zeros), [0, 0, 0])

    panel.get_by_role("button", name="Measure the gyroscope").click()
    expect(panel.get_by_role("progressbar")).to_be_visible()
    expect(panel.get_by_role("button", name="The depth is zero here")).to_be_disabled()
    expect(panel.get_by_text("The gyroscope's offset is")).to_be_visible()
    measured = saved(page, panel)[1]
    assert measured["gyro_bias"] != before["gyro_bias"]
    assert {**measured, "gyro_bias": 0} == {**before, "gyro_bias": 0}

    expected = before | {"pressure_offset": 250, "fin_zeros": [188, 161, 700, 356]}
    choose(panel, tmp_path / "other.json", expected)
    rows = panel.get_by_role("region", name="other.json would change:").get_by_role("row")
    offset = f"{before['pressure_offset'] / 100:.2f} hPa"
    expect(rows.filter(has_text="Pressure sensor")).to_have_text(f"Pressure sensor{offset}2.50 hPa")
    expect(rows.filter(has_text="zero")).to_have_text("Fin back left: zero726700")
    panel.get_by_role("button", name="Store on the board").click()
    expect(panel.get_by_text("Stored on the board.")).to_be_visible()
    panel.get_by_text("Values on the board").click()
    expect(panel.get_by_role("row", name="back left")).to_have_text("back left700risefall")
    expect(panel.get_by_role("definition").filter(has_text="hPa")).to_have_text("2.50hPa")
    assert saved(page, panel)[1] == expected


def test_files_that_cannot_be_stored_are_refused_in_words(page: Page, stack: Stack, tmp_path: Path) -> None:
    panel = opened(page, stack)
    before = saved(page, panel)[1]
    choose(panel, tmp_path / "part.json", {"fin_zeros": [1, 2, 3, 4]})
    expect(panel.get_by_role("alert")).to_contain_text(["part.json was not stored: “done” is missing"])
    # The form is right; the robot itself refuses the value.
    choose(panel, tmp_path / "mirrored.json", before | {"axes": ["x", "y", "-z"]})
    panel.get_by_role("button", name="Store on the board").click()
    expect(panel.get_by_role("alert")).to_contain_text(["mirrored.json was not stored: "])
    expect(panel.get_by_text("a mirrored chip does not exist")).to_be_visible()
    panel.get_by_role("button", name="Cancel").click()
    assert saved(page, panel)[1] == before


def test_missing_steps_are_named_with_the_way_to_the_bring_up(
    page: Page, stack: Stack, tmp_path: Path
) -> None:
    panel = opened(page, stack)
    before = saved(page, panel)[1]
    choose(panel, tmp_path / "new.json", before | {"done": ["fins", "motors", "axes", "gyro", "pressure"]})
    panel.get_by_role("button", name="Store on the board").click()
    expect(panel.get_by_text("2 steps are missing.")).to_be_visible()
    missing = ["factor of the battery's voltage", "polarity of the beacon detectors"]
    expect(panel.get_by_role("listitem")).to_have_text(missing)
    expect(panel.get_by_role("link", name="Go to Bring-up")).to_have_attribute("href", "#/bring-up")


def test_the_surface_is_moved_only_after_a_confirmation(page: Page, stack: Stack) -> None:
    panel = opened(page, stack)
    panel.get_by_role("button", name="The depth is zero here").click()
    panel.get_by_role("button", name="Cancel").click()
    panel.get_by_role("button", name="The depth is zero here").click()
    panel.get_by_role("button", name="Yes, depth is zero").click()
    expect(panel.get_by_text("The depth is measured from here.")).to_be_visible()


def test_nothing_is_changed_while_armed_or_by_a_viewer(browser: Browser, page: Page, stack: Stack) -> None:
    names = ("Measure the gyroscope", "The depth is zero here", "Restore from a file")
    hold_to_arm(page)
    panel = opened(page, stack)
    expect(panel.get_by_text("The robot is armed. Disarm it first.")).to_be_visible()
    for name in names:
        expect(panel.get_by_role("button", name=name)).to_be_disabled()
    with somebody(browser, stack, "viewer") as viewer:
        panel = opened(viewer, stack)
        expect(panel.get_by_text("Viewers can watch and press STOP.")).to_be_visible()
        for name in names:
            expect(panel.get_by_role("button", name=name)).to_be_disabled()
        assert saved(viewer, panel)[1]["battery_factor"] == 1
