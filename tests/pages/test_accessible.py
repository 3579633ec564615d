"""Accessibility of pages that show no live robot, checked by axe-core; tests/browser has the others."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, StorageState, expect

from tests.browser.axe import AXE, faults, faults_of_view, opened_for_axe
from tests.browser.opening import DESKTOP, PHONE
from tests.browser.pages import LIVE, PAGES, View
from tests.browser.site import Site


@pytest.fixture(scope="module", params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def seen(
    request: pytest.FixtureRequest, browser: Browser, site: Site, cookies: StorageState
) -> Iterator[Page]:
    """One page for all of these tests; none of them changes anything."""
    with opened_for_axe(browser, site, cookies, request.param) as page:
        yield page


@pytest.mark.parametrize("view", [page for page in PAGES if page not in LIVE], ids=lambda view: view.name)
def test_no_page_has_a_serious_accessibility_violation(seen: Page, site: Site, view: View) -> None:
    assert faults_of_view(seen, site, view) == []


def test_the_sign_in_page_has_no_serious_violation(browser: Browser, site: Site) -> None:
    context = browser.new_context(viewport=PHONE, color_scheme="dark")
    page = context.new_page()
    context.add_init_script(path=AXE)
    page.goto(site.url)
    expect(page.get_by_role("heading", name="Sign in")).to_be_visible()
    wrong = faults(page)
    context.close()
    assert wrong == []
