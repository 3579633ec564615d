"""Navigation: the heading of the next page gets the focus, and the current tab is in view."""

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize, expect

from tests.browser.site import Site

NARROW: ViewportSize = {"width": 300, "height": 640}
TABS = {
    "bench": "Bench",
    "parameters": "Parameters",
    "vision": "Vision",
}


def test_signing_in_has_a_title(browser: Browser, site: Site) -> None:
    context = browser.new_context()
    page = context.new_page()
    page.goto(site.url)
    expect(page.get_by_role("heading", name="Sign in")).to_be_visible()
    expect(page).to_have_title("Sign in to turtle · µ-CAT")
    context.close()


@pytest.mark.parametrize(
    "name", ["Sessions", "System", "Tune", "Missions", "Scenarios", "Comm tests", "Operate"]
)
def test_the_heading_of_the_next_page_gets_the_focus(page: Page, name: str) -> None:
    pages = page.get_by_role("navigation", name="Pages")
    first = "Sessions" if name == "System" else "System"
    pages.get_by_role("link", name=first, exact=True).click()
    # A heading gets the focus where one was there before it.
    expect(page.get_by_role("heading", level=1, name=first)).to_be_visible()
    link = pages.get_by_role("link", name=name, exact=True)
    link.focus()
    link.press("Enter")
    expect(page.get_by_role("heading", level=1, name=name)).to_be_focused()


@pytest.mark.parametrize("width", [320, 375, 390])
def test_every_name_of_a_page_is_in_view_on_the_narrowest_phones(
    browser: Browser, site: Site, cookies: StorageState, width: int
) -> None:
    size: ViewportSize = {"width": width, "height": 640}
    context = browser.new_context(viewport=size, storage_state=cookies, has_touch=True)
    page = context.new_page()
    page.goto(site.first)
    pages = page.get_by_role("navigation", name="Pages")
    for link in pages.get_by_role("link").all():
        expect(link).to_be_in_viewport(ratio=1)
    assert pages.evaluate("(one) => one.scrollWidth - one.clientWidth") == 0
    context.close()


def test_changing_views_of_a_page_keeps_the_focus_on_the_tab(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/tune/bench")
    tab = page.get_by_role("navigation", name="Tuning views").get_by_role("link", name="Parameters")
    tab.focus()
    tab.press("Enter")
    expect(tab).to_have_attribute("aria-current", "page")
    expect(tab).to_be_focused()


def test_the_current_tab_of_tune_is_in_view_where_there_is_little_room(
    browser: Browser, site: Site, cookies: StorageState
) -> None:
    context = browser.new_context(viewport=NARROW, storage_state=cookies, has_touch=True)
    page = context.new_page()
    for address, name in TABS.items():
        page.goto(f"{site.url}/#/tune/{address}")
        tabs = page.get_by_role("navigation", name="Tuning views")
        tab = tabs.get_by_role("link", name=name)
        expect(tab).to_have_attribute("aria-current", "page")
        expect(tab).to_be_in_viewport(ratio=1)
    # The last one: there is more before it, and that shows.
    assert "gradient" in str(tabs.evaluate("(one) => getComputedStyle(one).maskImage"))
    page.set_viewport_size({"width": 1440, "height": 900})
    expect(tabs.get_by_role("link", name="Bench")).to_be_in_viewport(ratio=1)
    page.wait_for_function("(one) => getComputedStyle(one).maskImage === 'none'", arg=tabs.element_handle())
    context.close()
