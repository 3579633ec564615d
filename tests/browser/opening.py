"""Chromium, and pages in it."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from weakref import WeakKeyDictionary

from playwright.sync_api import Browser, BrowserContext, Page, StorageState, ViewportSize, sync_playwright

from tests.browser.chromium import ARGUMENTS, HEADLESS_SHELL, SECRET, sign_in
from tests.browser.site import Site
from tests.waiting import SECONDS

DESKTOP: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}
SMALL_PHONE: ViewportSize = {"width": 360, "height": 640}
LYING_PHONE: ViewportSize = {"width": 844, "height": 390}


@contextmanager
def launched(*arguments: str) -> Iterator[Browser]:
    """Chromium without windows, with these arguments beside the usual ones."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=HEADLESS_SHELL, args=[*ARGUMENTS, *arguments], timeout=1000 * SECONDS
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


class SharedContext:
    """A context whose pages come one after the other; each finds the cookies and the storage of the first.

    A context of its own costs a page more than its contents. One empty page stays open, and with it the
    process of the site, which has compiled its code.
    """

    def __init__(self, browser: Browser, cookies: StorageState, options: dict[str, Any]) -> None:
        self._cookies = cookies
        self.context = browser.new_context(storage_state=cookies, **options)
        self._first = self.context.new_page()
        self._first.goto(f"{cookies['origins'][0]['origin']}/icon.svg")

    @contextmanager
    def opened(self, size: ViewportSize) -> Iterator[Page]:
        """A new page of this size."""
        before = self.context.pages
        page = self.context.new_page()
        try:
            page.set_viewport_size(size)
            yield page
        finally:
            for other in self.context.pages:
                if other not in before:
                    other.close()
            if before == [self._first]:
                self._forget()

    def _forget(self) -> None:
        """Forget what pages have stored and been granted."""
        self.context.clear_permissions()
        self.context.clear_cookies()
        self.context.add_cookies(self._cookies["cookies"])  # type: ignore[arg-type]
        self._first.evaluate(RESTORE, self._cookies["origins"][0]["localStorage"])


RESTORE = """(stored) => {
    localStorage.clear();
    for (const { name, value } of stored) localStorage.setItem(name, value);
}"""
_shared: WeakKeyDictionary[Browser, dict[str, SharedContext]] = WeakKeyDictionary()


@contextmanager
def shared_page(
    browser: Browser, cookies: StorageState, size: ViewportSize, **options: Any
) -> Iterator[Page]:
    """An empty page of a context with these options, which the next such page gets, too.

    Scripts that come before those of its documents are added to the page, not to its context.
    """
    contexts = _shared.setdefault(browser, {})
    key = json.dumps([cookies, options], sort_keys=True)
    if key not in contexts:
        contexts[key] = SharedContext(browser, cookies, options)
    with contexts[key].opened(size) as page:
        yield page


@contextmanager
def closing_pages(browser: Browser) -> Iterator[None]:
    """Close what a failed test has left open: such pages would take the computer from the tests after it."""
    before = list(browser.contexts)
    yield
    shared = [entry.context for entry in _shared.get(browser, {}).values()]
    for context in [candidate for candidate in browser.contexts if candidate not in (*before, *shared)]:
        context.close()


def signed_in(browser: Browser, site: Site) -> StorageState:
    """Cookies and storage of an operator who has just signed in."""
    context = browser.new_context()
    secret = sign_in(context, site.url, site.data)
    stored = context.storage_state()
    # The flight view has tests of its own; in those of a page nothing else comes by itself.
    stored["origins"] = [
        {
            "origin": site.url,
            "localStorage": [{"name": SECRET, "value": secret}, {"name": "mucat-flight", "value": "off"}],
        }
    ]
    context.close()
    return stored


@contextmanager
def opened_page(browser: Browser, site: Site, cookies: StorageState, size: ViewportSize) -> Iterator[Page]:
    """The page at this size; what its code complains about fails the test."""
    # Charts then move once a second, which leaves the computer to what is tested.
    with shared_page(browser, cookies, size, reduced_motion="reduce", color_scheme="dark") as page:
        complaints: list[str] = []
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(site.first)
        yield page
    assert complaints == [], complaints
