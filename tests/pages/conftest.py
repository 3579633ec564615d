"""One server and one Chromium for all tests of pages that need no robot; both end with them.

Playwright keeps an event loop running, which tests of other rooms could not stand beside their own.
"""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize

from tests.browser.opening import DESKTOP, PHONE, closing_pages, launched, opened_page, signed_in
from tests.browser.pages import stop_recordings
from tests.pages.dive_site import DiveSite


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with launched() as browser:
        yield browser


@pytest.fixture(autouse=True)
def _no_page_is_left(browser: Browser) -> Iterator[None]:
    with closing_pages(browser):
        yield


@pytest.fixture(scope="package")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DiveSite]:
    with DiveSite(tmp_path_factory.mktemp("data")) as site:
        yield site


@pytest.fixture(scope="package")
def cookies(browser: Browser, site: DiveSite) -> StorageState:
    """Cookies and storage of a signed-in operator."""
    return signed_in(browser, site)


@pytest.fixture(params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def any_page(
    request: pytest.FixtureRequest, browser: Browser, site: DiveSite, cookies: StorageState
) -> Iterator[Page]:
    """The page at both sizes; what its code complains about fails the test."""
    yield from open_page(browser, site, cookies, request.param)


@pytest.fixture
def page(browser: Browser, site: DiveSite, cookies: StorageState) -> Iterator[Page]:
    """The page at desktop size; what its code complains about fails the test."""
    yield from open_page(browser, site, cookies, DESKTOP)


def open_page(browser: Browser, site: DiveSite, cookies: StorageState, size: ViewportSize) -> Iterator[Page]:
    """The page at this size; afterwards nothing records."""
    with opened_page(browser, site, cookies, size) as page:
        yield page
        page.context.close()
        stop_recordings(site)
