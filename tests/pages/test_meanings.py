"""Meanings of figures and fields, by touch and keyboard as well as by a resting mouse."""

from playwright.sync_api import Browser, Page, StorageState, expect

from tests.browser.opening import PHONE
from tests.browser.site import Site


def test_a_tap_shows_the_meaning_of_a_gain(browser: Browser, site: Site, cookies: StorageState) -> None:
    context = browser.new_context(viewport=PHONE, storage_state=cookies, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto(site.url)
    # Until then the reasons against arming change, which moves what stands below them.
    expect(page.get_by_role("region", name="Arm").get_by_text("Ready to arm")).to_be_visible()
    page.get_by_role("tab", name="Control").tap()
    meaning = page.get_by_text("Set point of the depth", exact=True)
    expect(meaning).to_be_hidden()
    page.locator("summary", has_text="default").tap()
    expect(meaning).to_be_visible()
    page.locator("summary", has_text="default").tap()
    expect(meaning).to_be_hidden()
    context.close()


def test_a_key_shows_the_meaning_of_a_link_figure(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/system")
    link = page.get_by_role("region", name="Serial link")
    meaning = link.get_by_text("From a reliable frame to its acknowledgement")
    expect(meaning).to_be_hidden()
    term = link.locator("summary", has_text="Round trip")
    term.focus()
    term.press("Enter")
    expect(meaning).to_be_visible()


def test_a_meaning_stays_open_while_readings_come(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/system")
    # Browsers send this event late; readings come first on a page that has much to do.
    page.evaluate("addEventListener('toggle', (event) => event.stopImmediatePropagation(), true)")
    link = page.get_by_role("region", name="Serial link")
    link.locator("summary", has_text="Round trip").press("Enter")
    expect(link.get_by_text("From a reliable frame to its acknowledgement")).to_be_visible()
