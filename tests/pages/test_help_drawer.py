"""The help beside the page: its chapter, STOP in sight, and Esc, which is STOP wherever the focus is."""

import pytest
from playwright.sync_api import Browser, StorageState, ViewportSize, expect

from tests.browser.axe import AXE, faults
from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE, opened_page
from tests.pages.dive_site import DiveSite


def stops(site: DiveSite) -> int:
    return [name for name, _ in site.commands].count("stop")


@pytest.mark.parametrize("size", [DESKTOP, PHONE, LYING_PHONE], ids=["desktop", "phone", "lying"])
def test_the_chapter_opens_beside_the_page(
    browser: Browser, site: DiveSite, cookies: StorageState, size: ViewportSize
) -> None:
    with opened_page(browser, site, cookies, size) as page:
        page.goto(f"{site.url}/#/sessions")
        # It takes the focus when it appears.
        expect(page.get_by_role("heading", name="Sessions", level=1)).to_be_visible()
        link = page.get_by_role("link", name="Help for this page")
        link.focus()
        page.keyboard.press("Enter")
        drawer = page.get_by_role("region", name="Help")
        expect(drawer).to_be_focused()
        chapter = drawer.frame_locator("iframe")
        expect(chapter.get_by_role("heading", level=1)).to_contain_text("Sessions")
        page.evaluate(f"{AXE.read_text()};0")
        assert faults(page) == []
        # Nothing lies over STOP.
        page.get_by_role("button", name="STOP").click(trial=True)
        before = stops(site)
        chapter.get_by_role("heading", level=1).click()
        page.keyboard.press("Escape")
        expect(page.get_by_role("button", name="Stopped")).to_be_visible()
        assert stops(site) > before
        expect(drawer).to_be_visible()
        expect(drawer.get_by_role("link", name="Open in a tab")).to_have_attribute("target", "_blank")
        drawer.get_by_role("button", name="Close").click()
        expect(drawer).to_have_count(0)
        expect(link).to_be_focused()


def test_the_link_of_another_page_opens_its_chapter_and_closes_it(
    browser: Browser, site: DiveSite, cookies: StorageState
) -> None:
    with opened_page(browser, site, cookies, DESKTOP) as page:
        link = page.get_by_role("link", name="Help for this page")
        frame = page.get_by_role("region", name="Help").locator("iframe")
        link.click()
        expect(frame).to_have_attribute("src", "/help/run/access/")
        page.goto(f"{site.url}/#/tune")
        link.click()
        expect(frame).to_have_attribute("src", "/help/use/tune/")
        link.click()
        expect(frame).to_have_count(0)
