"""One Chromium for all tests of a folder, and its pages.

The folder's own conftest.py says which `site` they come from, and brings it back to its state in `_at_rest`.
Playwright keeps an event loop running, which tests of other rooms could not stand beside their own.
"""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, StorageState, expect

from tests.browser.opening import (
    DESKTOP,
    PHONE,
    closing_pages,
    launched,
    opened_page,
    signed_in,
    unopened_page,
)
from tests.browser.site import Site
from tests.waiting import SECONDS

expect.set_options(timeout=1000 * SECONDS)

__all__ = ["_no_page_is_left", "any_page", "browser", "cookies", "page", "unopened"]


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with launched() as browser:
        yield browser


@pytest.fixture(autouse=True)
def _no_page_is_left(browser: Browser) -> Iterator[None]:
    with closing_pages(browser):
        yield


@pytest.fixture(scope="package")
def cookies(browser: Browser, site: Site) -> StorageState:
    """Cookies and storage of a signed-in operator."""
    return signed_in(browser, site)


@pytest.fixture(params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def any_page(
    request: pytest.FixtureRequest, browser: Browser, site: Site, cookies: StorageState, _at_rest: None
) -> Iterator[Page]:
    """The page at both sizes; what its code complains about fails the test."""
    with opened_page(browser, site, cookies, request.param) as page:
        yield page


@pytest.fixture
def unopened(browser: Browser, cookies: StorageState, _at_rest: None) -> Iterator[Page]:
    """A page at desktop size that is not open yet."""
    with unopened_page(browser, cookies, DESKTOP) as page:
        yield page


@pytest.fixture
def page(browser: Browser, site: Site, cookies: StorageState, _at_rest: None) -> Iterator[Page]:
    """The page at desktop size; what its code complains about fails the test."""
    with opened_page(browser, site, cookies, DESKTOP) as page:
        yield page
