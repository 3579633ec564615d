"""Colours: the theme of the device or the chosen one, at every width; more contrast; forced colours."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

import pytest
from playwright.sync_api import Browser, Locator, Page, StorageState, expect

from tests.browser.site import Site

WIDTHS = (360, 390, 768, 1024, 1366, 1920)


@contextmanager
def opened(
    browser: Browser,
    site: Site,
    cookies: StorageState,
    *,
    scheme: Literal["dark", "light"] = "dark",
    contrast: Literal["more", "no-preference"] = "no-preference",
    forced: bool = False,
) -> Iterator[Page]:
    """A page without charts and camera on a device with these colours."""
    context = browser.new_context(
        storage_state=cookies,
        viewport={"width": 1440, "height": 900},
        color_scheme=scheme,
        contrast=contrast,
        forced_colors="active" if forced else "none",
        reduced_motion="reduce",
    )
    page = context.new_page()
    page.goto(site.first)
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    yield page
    context.close()


def theme(page: Page) -> Locator:
    """Return the document's element with its theme."""
    return page.locator("html")


@pytest.mark.parametrize(("scheme", "expected"), [("dark", "dark"), ("light", "sunlight")])
def test_the_first_visit_follows_the_device(
    browser: Browser,
    site: Site,
    cookies: StorageState,
    scheme: Literal["dark", "light"],
    expected: str,
) -> None:
    with opened(browser, site, cookies, scheme=scheme) as page:
        expect(theme(page)).to_have_attribute("data-theme", expected)
        page.emulate_media(color_scheme="light")
        expect(theme(page)).to_have_attribute("data-theme", "sunlight")


def test_a_chosen_theme_overrides_the_device_s(browser: Browser, site: Site, cookies: StorageState) -> None:
    with opened(browser, site, cookies) as page:
        page.get_by_role("button", name="Page settings").click()
        page.get_by_role("radio", name="Sunlight").check()
        expect(theme(page)).to_have_attribute("data-theme", "sunlight")
        page.reload()
        expect(theme(page)).to_have_attribute("data-theme", "sunlight")
        page.get_by_role("button", name="Page settings").click()
        page.get_by_role("radio", name="Same as device").check()
        expect(theme(page)).to_have_attribute("data-theme", "dark")


def test_the_theme_is_chosen_at_every_width(browser: Browser, site: Site, cookies: StorageState) -> None:
    with opened(browser, site, cookies) as page:
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 844})
            page.get_by_role("button", name="Page settings").click()
            page.get_by_role("radio", name="Sunlight").check()
            expect(theme(page)).to_have_attribute("data-theme", "sunlight")
            page.get_by_role("radio", name="Dark").check()
            expect(theme(page)).to_have_attribute("data-theme", "dark")
            page.get_by_role("button", name="Close", exact=True).click()


def colour(element: Locator, name: str) -> str:
    """Return a computed colour."""
    return str(element.evaluate(f"(one) => getComputedStyle(one)['{name}']"))


def test_more_contrast_on_the_device_s_request(browser: Browser, site: Site, cookies: StorageState) -> None:
    with opened(browser, site, cookies) as page:
        plain = colour(page.get_by_role("heading", level=1), "color")
    with opened(browser, site, cookies, contrast="more") as page:
        assert colour(page.get_by_role("heading", level=1), "color") != plain


def test_forced_colours_show_the_selection_and_stop(
    browser: Browser, site: Site, cookies: StorageState
) -> None:
    with opened(browser, site, cookies, forced=True) as page:
        page.goto(f"{site.url}/#/operate")
        pages = page.get_by_role("navigation", name="Pages")
        here, there = pages.get_by_role("link", name="Operate"), pages.get_by_role("link", name="System")
        assert colour(here, "backgroundColor") != colour(there, "backgroundColor")
        chosen = page.get_by_role("button", name="Automatic", exact=True)
        other = page.get_by_role("button", name="Manual", exact=True)
        assert colour(chosen, "backgroundColor") != colour(other, "backgroundColor")
        stop = page.get_by_role("button", name="STOP")
        assert colour(stop, "backgroundColor") not in {
            colour(other, "backgroundColor"),
            colour(here, "backgroundColor"),
        }
