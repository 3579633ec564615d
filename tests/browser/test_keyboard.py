"""The keyboard: bookmarks during driving, Esc is STOP, two presses arm, single keys can be disabled."""

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.bookmarks import notes
from tests.browser.driving import arm_by_hand, expect_surge
from tests.stack import Stack


@pytest.fixture
def session(stack: Stack) -> int:
    """A recording session."""
    return int(stack.api.post("/sessions", json={"name": "keys"}).raise_for_status().json()["id"])


def test_setting_a_bookmark_does_not_take_the_keyboard_from_driving(
    page: Page, stack: Stack, session: int
) -> None:
    arm_by_hand(page)
    page.keyboard.press("m")
    notice = page.get_by_role("region", name="Bookmark", exact=True)
    expect(notice).to_contain_text(re.compile(r"Marked \d\d:\d\d"))
    page.keyboard.down("w")
    expect_surge(page, "forwards")
    page.keyboard.up("w")
    expect_surge(page, "")
    notice.get_by_role("button", name="Add note").click()
    field = notice.get_by_label(re.compile("^Note at"))
    expect(field).to_be_focused()
    field.fill("bubbles")
    field.press("Enter")
    expect(notice).to_be_hidden()
    assert notes(stack, session) == ["bubbles"]


def test_escape_stops_and_does_not_close_a_sheet(page: Page) -> None:
    opener = page.get_by_role("button", name=re.compile("^Control:"))
    opener.press("Enter")
    sheet = page.get_by_role("dialog", name="Control of the robot")
    expect(sheet).to_be_focused()
    expect(sheet).to_contain_text("Esc is STOP")
    page.keyboard.press("Escape")
    expect(page.get_by_role("status").filter(has_text="Stopped: the robot is disarmed")).to_be_attached()
    expect(sheet).to_be_visible()
    sheet.get_by_role("button", name="Close").click()
    expect(sheet).to_be_hidden()
    expect(opener).to_be_focused()
    opener.press("Enter")
    expect(sheet).to_be_visible()
    page.get_by_role("region", name="Events").click()
    expect(sheet).to_be_hidden()


def click(button: Locator) -> None:
    """Click without a pointer, as screen readers, switches and voice control do."""
    button.evaluate("(one) => one.click()")


def test_two_presses_arm(page: Page) -> None:
    hold = page.get_by_role("button", name="Hold to arm")
    again = page.get_by_role("button", name="Press again to arm")
    expect(hold).to_be_enabled()
    click(hold)
    expect(again).to_be_visible()
    expect(page.get_by_role("status").filter(has_text="Press again to arm")).to_be_attached()
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
    # A press without a second one has no effect.
    expect(hold).to_be_visible()
    click(hold)
    click(again)
    expect(page.get_by_text("The fins may move")).to_be_visible()


def test_a_short_press_of_the_mouse_does_not_count(page: Page) -> None:
    hold = page.get_by_role("button", name="Hold to arm")
    expect(hold).to_be_enabled()
    hold.click()
    expect(page.get_by_role("button", name="Press again to arm")).to_have_count(0)
    hold.dblclick()
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
    expect(page.get_by_role("button", name="Press again to arm")).to_have_count(0)


def test_single_keys_can_be_switched_off(page: Page, stack: Stack, session: int) -> None:
    settings = page.get_by_role("button", name="Page settings")
    settings.click()
    page.get_by_role("checkbox", name="Single-key shortcuts").uncheck()
    page.reload()
    arm_by_hand(page)
    page.keyboard.press("m")
    page.keyboard.press("g")
    page.keyboard.down("w")
    expect(page.get_by_role("region", name="Drive")).to_contain_text("Keys are off")
    page.keyboard.up("w")
    expect(page.get_by_role("button", name="Depth hold")).to_have_attribute("aria-pressed", "false")
    settings.click()
    page.get_by_role("checkbox", name="Single-key shortcuts").check()
    page.keyboard.press("g")
    expect(page.get_by_role("button", name="Depth hold")).to_have_attribute("aria-pressed", "true")
    assert notes(stack, session) == []
