"""One server for all tests of pages that need no robot."""

from collections.abc import Iterator

import pytest

from tests.browser.fixtures import _no_page_is_left, any_page, browser, cookies, page, unopened
from tests.browser.pages import stop_recordings
from tests.pages.dive_site import DiveSite

__all__ = ["_no_page_is_left", "any_page", "browser", "cookies", "page", "unopened"]


@pytest.fixture(scope="package")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DiveSite]:
    with DiveSite(tmp_path_factory.mktemp("data")) as site:
        yield site


@pytest.fixture
def _at_rest(site: DiveSite) -> Iterator[None]:
    """Afterwards nothing records."""
    yield
    stop_recordings(site)
