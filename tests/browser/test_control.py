"""Who has control: taken, asked for, kept, given, and passed on by itself to who has asked."""

import re

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.people import somebody
from tests.stack import Stack

MINE = re.compile("^Control: this page$")
PASSES_MS = 12_000


def control(page: Page) -> Locator:
    """What the bar says of the control."""
    return page.get_by_role("button", name=re.compile("^Control:"))


def ask(page: Page) -> None:
    """Ask for the control that somebody else has."""
    control(page).click()
    page.get_by_role("button", name="Ask for control").click()
    page.keyboard.press("Escape")


def test_control_goes_from_one_to_the_other(page: Page, browser: Browser, stack: Stack) -> None:
    expect(control(page)).to_have_accessible_name(MINE)
    request = page.get_by_role("region", name="Request for control")
    with somebody(browser, stack, "operator") as other:
        expect(control(other)).not_to_have_accessible_name(MINE)
        expect(other.get_by_role("button", name="Hold to arm")).to_be_disabled()

        ask(other)
        expect(request).to_be_visible()
        page.get_by_role("button", name="STOP").click()
        request.get_by_role("button", name="Keep").click()
        expect(other.get_by_role("status").filter(has_text="Control stays with")).to_be_visible()
        expect(control(page)).to_have_accessible_name(MINE)

        control(page).click()
        page.get_by_role("button", name="Give it up").click()
        expect(control(other)).to_have_accessible_name("Control: nobody")
        control(other).click()
        other.get_by_role("button", name="Take control").click()
        expect(control(other)).to_have_accessible_name(MINE)

        page.get_by_role("button", name="Ask for control").click()
        other.get_by_role("button", name="Hand over", exact=True).click()
        expect(control(page)).to_have_accessible_name(MINE)
        expect(page.get_by_text("handed control over to").last).to_be_attached()

        # Nobody has asked.
        page.get_by_role("button", name=re.compile("^Hand over to .*, page")).click()
        expect(control(other)).to_have_accessible_name(MINE)
        page.keyboard.press("Escape")
        control(other).click()
        other.get_by_role("button", name=re.compile("^Hand over to .*, page")).click()
        expect(control(page)).to_have_accessible_name(MINE)
        other.keyboard.press("Escape")

        ask(other)
        expect(request).to_be_visible()
        expect(control(other)).to_have_accessible_name(MINE, timeout=PASSES_MS)
        expect(request).to_be_hidden()
        expect(page.get_by_role("button", name="Hold to arm")).to_be_disabled()
