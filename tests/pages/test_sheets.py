"""STOP stays whole and can be pressed, whatever opens over a page."""

import re

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize, expect

from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE, SMALL_PHONE, unopened_page
from tests.pages.dive_site import DiveSite
from tests.pages.flying import Flown

SIZES = {"desktop": DESKTOP, "phone": PHONE, "small phone": SMALL_PHONE, "lying phone": LYING_PHONE}
# The points of STOP, from edge to edge, at which something else would be pressed.
COVERED = """() => {
    const stop = document.querySelector('button.stop');
    const { left, top, width, height } = stop.getBoundingClientRect();
    const shares = [0.1, 0.5, 0.9];
    const points = shares.flatMap((x) => shares.map((y) => [left + x * width, top + y * height]));
    return points.filter(([x, y]) => !stop.contains(document.elementFromPoint(x, y)));
}"""
ALARMS = [{"fault": f"fault_{number}"} for number in range(8)]
"""So many that their list is longer than a screen."""


def whole(page: Page) -> bool:
    """Return whether nothing lies over any part of STOP."""
    return bool(page.evaluate(COVERED) == [])


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
@pytest.mark.parametrize("address", ["people", "flight"])
def test_no_sheet_and_no_drawer_lies_over_stop(
    browser: Browser, site: DiveSite, cookies: StorageState, size: ViewportSize, address: str
) -> None:
    with unopened_page(browser, cookies, size) as page:
        flown = Flown(page)
        flown.alarms = ALARMS
        page.goto(f"{site.url}/#/{address}")
        expect(page.get_by_role("button", name=re.compile("^8 alarms"))).to_be_visible()
        openers = page.locator("button.opener:visible")
        assert openers.count() >= (4 if address == "people" else 3)
        for opener in openers.all():
            opener.click()
            sheet = page.locator(".sheet:popover-open")
            # Some fetch what they hold: beside the head and the hint on closing there is something.
            expect(sheet.locator(":scope > *").nth(2)).to_be_attached()
            assert whole(page), opener.get_attribute("aria-label")
            sheet.get_by_role("button", name="Close").click()
            expect(sheet).to_have_count(0)
        help_link = page.get_by_role("link", name="Help for this page")
        if help_link.count() > 0:
            help_link.click()
            expect(page.get_by_role("region", name="Help")).to_be_focused()
            assert whole(page), "help"
        if address == "flight":
            for title in ("Controls", "Charts and console"):
                page.get_by_role("button", name=title, exact=True).press("Enter")
                expect(page.get_by_role("button", name=f"Close {title}")).to_be_visible()
                assert whole(page), title
