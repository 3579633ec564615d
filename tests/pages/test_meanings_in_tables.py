"""Meanings of headings, axes, signals and chips are there for fingers, keys and screen readers too."""

import re

from playwright.sync_api import Browser, Locator, Page, StorageState, ViewportSize, expect

from tests.browser.opening import PHONE
from tests.browser.pages import topics
from tests.browser.site import Site
from tests.waiting import wait_for

ROOMY: ViewportSize = {"width": 1920, "height": 1080}
"""Its layout shows the serial link."""


def test_a_finger_asks_what_a_signal_and_an_axis_mean(
    browser: Browser, site: Site, cookies: StorageState
) -> None:
    context = browser.new_context(viewport=PHONE, storage_state=cookies, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto(site.url)
    # Until then the reasons against arming change, which moves what stands below them.
    expect(page.get_by_role("region", name="Arm").get_by_text("Ready to arm")).to_be_visible()
    for tab, panel, text in (
        ("Motion", "Depth over time", "depth.depth: "),
        ("Sensors", "Inertial sensor", "Axis pointing forwards"),
    ):
        page.get_by_role("tab", name=tab).tap()
        shown = page.get_by_role("region", name=panel)
        meaning = shown.get_by_text(text)
        expect(meaning).to_be_hidden()
        shown.locator("summary").first.tap()
        expect(meaning).to_be_visible()
    context.close()


def test_a_key_asks_what_the_quality_of_the_link_means(page: Page) -> None:
    page.set_viewport_size(ROOMY)
    page.get_by_role("link", name="Operate").click()
    page.reload()
    link = page.get_by_role("region", name="Serial link")
    ask_by_key(link.locator("summary", has_text="Quality"), link.get_by_text("Share of the board’s frames"))


def ask_by_key(term: Locator, meaning: Locator) -> None:
    """Press a name with the keyboard; its meaning is hidden before and shown after."""
    expect(meaning).to_be_hidden()
    term.focus()
    term.press("Enter")
    expect(meaning).to_be_visible()


def test_a_chip_of_the_export_shows_its_meaning_to_a_key(page: Page, site: Site) -> None:
    session = site.api.post("/sessions", json={"name": "chips"}).json()["id"]
    wait_for(lambda: "depth" in topics(site, session), "samples of depth")
    site.api.post(f"/sessions/{session}/stop").raise_for_status()
    page.goto(f"{site.url}/#/sessions/{session}/data")
    page.get_by_role("radio", name=re.compile("CSV")).first.check(force=True)
    chip = page.get_by_role("checkbox", name="depth", exact=True)
    chip.focus()
    expect(chip).to_have_accessible_description(re.compile("depth", re.IGNORECASE))
    expect(page.get_by_text(re.compile("^depth: "))).to_be_visible()
