"""Control: taking, taking over, releasing."""

import re

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.people import somebody
from tests.pages.dive_site import DiveSite

MINE = re.compile("^Control: you have control$")


def control(page: Page) -> Locator:
    """Text of the bar's control button."""
    return page.get_by_role("button", name=re.compile("^Control:"))


def test_control_passes_from_one_page_to_another(page: Page, browser: Browser, site: DiveSite) -> None:
    page.get_by_role("link", name="Operate").click()
    expect(control(page)).to_have_accessible_name(MINE)
    with somebody(browser, site, "operator") as other:
        expect(control(other)).not_to_have_accessible_name(MINE)
        expect(other.get_by_role("button", name="Hold to arm")).to_be_disabled()

        # Taking it over is confirmed, and the page that loses it says so.
        control(other).click()
        other.get_by_role("button", name="Take over").click()
        other.get_by_role("button", name="Cancel").click()
        expect(control(page)).to_have_accessible_name(MINE)
        other.get_by_role("button", name="Take over").click()
        other.get_by_role("button", name="Take over now").click()
        expect(control(other)).to_have_accessible_name(MINE)
        lost = page.get_by_role("alert").filter(has_text="took control from this page")
        expect(lost).to_be_visible()
        expect(page.get_by_role("button", name="Hold to arm")).to_be_disabled()
        page.get_by_role("button", name="STOP").click()
        lost.get_by_role("button", name="Close").click()
        expect(lost).to_have_count(0)
        expect(page.get_by_text("took over control from").last).to_be_attached()

        other.get_by_role("button", name="Release control").click()
        expect(control(page)).to_have_accessible_name("Control: nobody has control")
        control(page).click()
        page.get_by_role("button", name="Take control").click()
        expect(control(page)).to_have_accessible_name(MINE)
        expect(control(other)).not_to_have_accessible_name(MINE)
