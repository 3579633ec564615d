"""Parameters: a gain changed while armed, undone, saved in a profile and restored."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.people import somebody
from tests.stack import Stack

KP = "depth.pid.kp"
AMPLITUDE = "fins.amplitude"


def value(stack: Stack, name: str) -> object:
    listed = stack.api.get("/parameters").raise_for_status().json()["parameters"]
    return next(parameter["value"] for parameter in listed if parameter["name"] == name)


@pytest.fixture
def amplitude(stack: Stack) -> Iterator[None]:
    """Restores the amplitude once the page has been closed."""
    yield
    stack.api.post("/robot/commands/parameters", json={"values": {AMPLITUDE: 1.6}}).raise_for_status()


@pytest.mark.usefixtures("amplitude")
def test_a_gain_is_changed_live_undone_saved_and_restored(any_page: Page, stack: Stack) -> None:
    page = any_page
    page.goto(f"{stack.url}/#/tune/parameters")
    # A search of before does not hide what is found.
    page.get_by_label("Find parameters").fill("amplitude")
    gain = page.get_by_label(KP, exact=True)
    expect(gain).to_have_count(0)
    page.keyboard.press("Control+k")
    page.keyboard.type(KP)
    expect(page.get_by_role("option", name=KP).first).to_be_visible()
    page.keyboard.press("Enter")
    expect(gain).to_be_focused()
    expect(gain).to_be_in_viewport()
    page.get_by_label("Find parameters").fill("pid metre")
    before = str(value(stack, KP)).removesuffix(".0")
    expect(gain).to_have_value(before)

    gain.fill("51")
    expect(page.get_by_role("button", name="Apply 1 change")).to_be_disabled()
    gain.fill("4.5")
    gain.press("Enter")
    changes = page.get_by_role("region", name="Changes")
    expect(changes.get_by_text(f"{before} → 4.5").first).to_be_visible()
    assert value(stack, KP) == 4.5

    changes.get_by_role("button", name="Undo").click()
    expect(gain).to_have_value(before)
    expect(changes.get_by_text("undone by Chromium").first).to_be_visible()

    # Parameters of the chip are changed the same way, and confirmed by the chip.
    page.get_by_label("Find parameters").fill("")
    page.get_by_label(AMPLITUDE, exact=True).fill("0.9")
    page.get_by_role("button", name="Apply 1 change").click()
    row = page.get_by_role("listitem").filter(has=page.get_by_label(AMPLITUDE, exact=True))
    expect(row.get_by_role("button", name="Default 1.6")).to_be_visible()
    # Each new change moves the profiles down, which are below them.
    newest = changes.get_by_role("listitem").first
    expect(newest).to_contain_text("1.6 → 0.9")
    name = f"small strokes {page.viewport_size and page.viewport_size['width']}"
    page.get_by_label("Save present values as").fill(name)
    page.get_by_role("button", name="Save", exact=True).click()
    restore = page.get_by_role("button", name=f"Restore {name}", exact=True)
    expect(restore).to_be_visible()

    row.get_by_role("button", name="Default 1.6").click()
    page.get_by_role("button", name="Apply 1 change").click()
    expect(page.get_by_label(AMPLITUDE, exact=True)).to_have_value("1.6")
    expect(newest).to_contain_text("0.9 → 1.6")
    page.get_by_text("Compare", exact=True).click()
    page.get_by_label("Compare this profile").select_option(label=name)
    difference = page.get_by_role("row").filter(has_text=AMPLITUDE)
    expect(difference).to_have_text(f"{AMPLITUDE}0.91.6")

    restore.click()
    expect(page.get_by_text("1 parameter changed")).to_be_visible()
    expect(page.get_by_label(AMPLITUDE, exact=True)).to_have_value("0.9")
    assert value(stack, AMPLITUDE) == 0.9


def test_a_viewer_sees_parameters_and_the_reason_why_they_are_fixed(browser: Browser, stack: Stack) -> None:
    with somebody(browser, stack, "viewer") as page:
        page.goto(f"{stack.url}/#/tune/parameters")
        expect(page.get_by_label(KP, exact=True)).to_be_disabled()
        expect(page.get_by_role("note")).to_contain_text("Viewers can watch")
        expect(page.get_by_role("button", name="Undo")).to_be_disabled()
