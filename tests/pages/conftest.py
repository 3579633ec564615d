"""One server for all tests of pages that need no robot."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from tests.browser.fixtures import _no_page_is_left, any_page, cookies, page
from tests.browser.opening import launched
from tests.browser.pages import stop_recordings
from tests.pages.dive_site import DiveSite

__all__ = ["_no_page_is_left", "any_page", "cookies", "page"]


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Chromium without its optimizing compilers: a page is gone before their work is worth it."""
    with launched("--js-flags=--no-opt,--no-maglev") as browser:
        yield browser


@pytest.fixture(scope="package")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DiveSite]:
    with DiveSite(tmp_path_factory.mktemp("data")) as site:
        yield site


@pytest.fixture
def _at_rest(site: DiveSite) -> Iterator[None]:
    """Afterwards nothing records."""
    yield
    stop_recordings(site)
