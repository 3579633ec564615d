"""Chromium, and pages in it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import Browser, BrowserContext, Page, StorageState, ViewportSize, sync_playwright

from tests.browser.chromium import ARGUMENTS, GUIDE, HEADLESS_SHELL, NO_GUIDE, SECRET, sign_in
from tests.browser.site import Site
from tests.waiting import SECONDS

DESKTOP: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}
SMALL_PHONE: ViewportSize = {"width": 360, "height": 640}
LYING_PHONE: ViewportSize = {"width": 844, "height": 390}


@contextmanager
def launched() -> Iterator[Browser]:
    """Chromium without windows."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=HEADLESS_SHELL, args=ARGUMENTS, timeout=1000 * SECONDS
        )
        _have_patience(browser)
        yield browser
        browser.close()


def _have_patience(browser: Browser) -> None:
    """Give an action of a page the time for which tests wait, not Playwright's 30 s."""
    new_context = browser.new_context

    def new_patient_context(**options: Any) -> BrowserContext:
        context = new_context(**options)
        context.set_default_timeout(1000 * SECONDS)
        return context

    browser.new_context = new_patient_context  # type: ignore[method-assign]


@contextmanager
def closing_pages(browser: Browser) -> Iterator[None]:
    """Close what a failed test has left open: such pages would take the computer from the tests after it."""
    before = list(browser.contexts)
    yield
    for context in [candidate for candidate in browser.contexts if candidate not in before]:
        context.close()


def signed_in(browser: Browser, site: Site) -> StorageState:
    """Cookies and storage of an operator who has just signed in."""
    context = browser.new_context()
    secret = sign_in(context, site.url, site.data)
    stored = context.storage_state()
    # The flight view and the first dive have tests of their own; in those of a page nothing else comes.
    stored["origins"] = [
        {
            "origin": site.url,
            "localStorage": [
                {"name": SECRET, "value": secret},
                {"name": "mucat-flight", "value": "off"},
                {"name": GUIDE, "value": NO_GUIDE},
            ],
        }
    ]
    context.close()
    return stored


@contextmanager
def opened_page(browser: Browser, site: Site, cookies: StorageState, size: ViewportSize) -> Iterator[Page]:
    """The page at this size; what its code complains about fails the test."""
    with unopened_page(browser, cookies, size) as page:
        page.goto(site.first)
        yield page


@contextmanager
def unopened_page(browser: Browser, cookies: StorageState, size: ViewportSize) -> Iterator[Page]:
    """The same before it is opened, for tests that change what it hears from the first moment on."""
    # Charts then move once a second, which leaves the computer to what is tested.
    context = browser.new_context(
        viewport=size, storage_state=cookies, reduced_motion="reduce", color_scheme="dark"
    )
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    yield page
    context.close()
    assert complaints == [], complaints
