"""The page of gamepads: a live picture, assignments, files; and no button leaves it."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, StorageState, ViewportSize, expect

from tests.browser.axe import AXE, FOR_SUNLIGHT, faults
from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE
from tests.pages.dive_site import DiveSite

# In place of a browser's own gamepads, which no test can move.
FAKE = """
globalThis.makePad = (index, id, mapping = 'standard') => ({
  index, id, mapping, connected: true, axes: [0, 0, 0, 0],
  buttons: Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 })),
  get timestamp() { return performance.now(); },
});
globalThis.pads = [];
navigator.getGamepads = () => globalThis.pads;
globalThis.press = (index, pressed) => {
  globalThis.pads[0].buttons[index] = { pressed, touched: pressed, value: Number(pressed) };
};
"""
PLUG_IN = "pads.push(makePad(0, 'Test pad (Vendor: 0000)')); dispatchEvent(new Event('gamepadconnected'))"


@pytest.fixture(params=[DESKTOP, PHONE, LYING_PHONE], ids=["desktop", "phone", "lying"])
def size(request: pytest.FixtureRequest) -> Any:
    return request.param


@pytest.fixture
def shown(browser: Browser, site: DiveSite, cookies: StorageState, size: ViewportSize) -> Iterator[Page]:
    """The page, with a gamepad whose sticks rest."""
    context = browser.new_context(
        viewport=size, storage_state=cookies, reduced_motion="reduce", color_scheme="dark"
    )
    context.add_init_script(FAKE)
    context.add_init_script(path=AXE)
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(f"{site.url}/#/gamepads")
    expect(page.get_by_text("No gamepad seen")).to_be_visible()
    page.evaluate(PLUG_IN)
    expect(page.get_by_role("region", name="Test pad")).to_be_visible()
    yield page
    context.close()
    assert complaints == []


def motion(page: Page, name: str) -> Locator:
    """Return the row of an axis of the robot."""
    return page.get_by_role("region", name="Assignments").get_by_role("group", name=name, exact=True)


def test_a_gamepad_is_tried_and_assigned_by_the_keyboard(shown: Page, site: DiveSite) -> None:
    page = shown
    before = len(site.commands)
    forwards = motion(page, "Forwards").locator("output").first
    page.evaluate("pads[0].axes = [0, 0, 0, -1]")
    expect(forwards).to_have_text("+1.00")
    page.evaluate("press(1, true)")
    expect(page.get_by_label("Button 1, down")).to_be_visible()
    page.evaluate("pads[0].axes = [0, 0, 0, 0]; press(1, false)")
    expect(forwards).to_have_text("0.00")

    page.get_by_role("button", name="Forwards, Stick: Axis 3. Assign").focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Move a stick for: Forwards. Cancel")).to_be_focused()
    page.evaluate("pads[0].axes = [0, 1, 0, 0]")
    expect(page.get_by_role("button", name="Forwards, Stick: Axis 1. Assign")).to_be_visible()
    expect(page.get_by_role("button", name="Vertical, Stick: none. Assign")).to_be_visible()
    expect(forwards).to_have_text("+1.00")
    dead = page.get_by_role("slider", name="Forwards: Dead zone")
    if page.viewport_size != DESKTOP:
        expect(dead).to_be_hidden()
        motion(page, "Forwards").get_by_text("Dead zone and curve").click()
    dead.focus()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    expect(dead).to_have_value("0.25")
    page.evaluate("pads[0].axes = [0, 0.24, 0, 0]")
    expect(forwards).to_have_text("0.00")

    page.get_by_role("button", name="Snapshot: A. Assign").focus()
    page.keyboard.press("Enter")
    page.evaluate("press(7, true)")
    expect(page.get_by_role("button", name="Snapshot: RT. Assign")).to_be_visible()
    page.reload()
    page.evaluate(PLUG_IN)
    expect(page.get_by_role("button", name="Forwards, Stick: Axis 1. Assign")).to_be_visible()
    assert faults(page) == []
    page.evaluate("document.documentElement.dataset.theme = 'sunlight'")
    assert faults(page, FOR_SUNLIGHT) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert len(site.commands) == before, "the page of gamepads moves the robot"


@pytest.mark.parametrize("size", [DESKTOP], ids=["desktop"])
def test_assignments_go_to_a_file_and_come_back(shown: Page, tmp_path: Path) -> None:
    page = shown
    with page.expect_download() as download:
        page.get_by_role("button", name="Export").click()
    assert download.value.suggested_filename == "gamepad-test-pad.json"
    saved = json.loads(Path(download.value.path()).read_text())
    saved["motions"][0]["stick"]["dead"] = 0.4
    chooser = page.get_by_label("File with the assignments of a gamepad")
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text(json.dumps(saved))
    bad.write_text(json.dumps({**saved, "version": 9}))
    chooser.set_input_files(bad)
    expect(page.get_by_role("alert").filter(has_text="bad.json: from another version")).to_be_visible()
    chooser.set_input_files(good)
    expect(page.get_by_text("Assignments of Test pad imported.")).to_be_visible()
    expect(page.get_by_role("slider", name="Forwards: Dead zone")).to_have_value("0.4")
    page.get_by_role("button", name="Back to the usual ones").click()
    expect(page.get_by_role("slider", name="Forwards: Dead zone")).to_have_value("0.2")


@pytest.mark.parametrize("size", [DESKTOP], ids=["desktop"])
def test_several_gamepads_are_told_apart_and_odd_ones_named(shown: Page) -> None:
    page = shown
    page.evaluate("pads.push(makePad(1, 'Other pad'), { ...makePad(2, 'Headset', ''), axes: [] })")
    expect(page.get_by_text("Headset has no sticks and is ignored.")).to_be_visible()
    page.evaluate("pads[1].axes = [0.19, 0, NaN, 0]")
    page.get_by_role("button", name="Other pad").click()
    expect(page.get_by_text("Axis 2 gives no number; it counts as at rest.")).to_be_visible()
    expect(page.get_by_text("Axis 0 rests at +0.19, within its dead zone of 0.20.")).to_be_visible()
    page.get_by_role("button", name="The one that is moved").click()
    page.evaluate("pads[0].axes = [0, 0, 0, -1]")
    expect(page.get_by_role("region", name="Test pad").get_by_text("drives")).to_be_visible()
    page.evaluate("pads.splice(0)")
    expect(page.get_by_text("No gamepad seen")).to_be_visible()


@pytest.mark.parametrize("size", [DESKTOP], ids=["desktop"])
def test_no_button_leaves_the_page_though_a_system_takes_it_for_back(shown: Page) -> None:
    page = shown
    went = "new Promise((went) => { addEventListener('popstate', went, { once: true }); history.back(); })"
    for _ in range(2):
        page.evaluate("press(1, true)")
        expect(page.get_by_label("Button 1, down")).to_be_visible()
        page.evaluate(went)
        page.evaluate("press(1, false)")
        expect(page.get_by_label("Button 1", exact=True)).to_be_visible()
        assert page.url.endswith("#/gamepads")
    # Whoever goes back by the browser does.
    page.get_by_role("link", name="Operate").first.click()
    expect(page.get_by_role("heading", name="Camera")).to_be_visible()
    page.go_back()
    expect(page.get_by_role("heading", name="Gamepads")).to_be_visible()
