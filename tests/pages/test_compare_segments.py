"""Sessions compared by segments: in the address, and with a better value only between like ones."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from server.platform.settings import Settings
from server.platform.store import Store
from tests.browser.opening import DESKTOP, opened_page, signed_in
from tests.pages.dive_site import DiveSite, recorded_site
from tests.server.analysis.dives import STEPPED, dive, record


def record_dives(store: Store, settings: Settings) -> None:
    record(store, settings, dive(), name="two steps")
    record(store, settings, dive(begin=STEPPED - 3.0, lost=4), name="late", started=STEPPED - 3.5)


@pytest.fixture(scope="module")
def dives(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DiveSite]:
    """A server that has two dives, whose first segments last 10 s and 3.5 s."""
    with recorded_site(tmp_path_factory.mktemp("data"), record_dives) as site:
        yield site


@pytest.fixture
def page(browser: Browser, dives: DiveSite) -> Iterator[Page]:
    with opened_page(browser, dives, signed_in(browser, dives), DESKTOP) as page:
        yield page


def test_a_better_value_is_marked_between_like_segments_only(page: Page, dives: DiveSite) -> None:
    page.goto(f"{dives.url}/#/sessions/compare/1,2")
    unlike = page.get_by_text("No value is marked as better")
    better = page.locator("button.best")
    expect(unlike).to_contain_text("“two steps” lasts 10.0 s, “late” 3.5 s.")
    expect(better).to_have_count(0)

    page.get_by_role("button", name="Segments", exact=True).click()
    expect(unlike).to_have_count(0)
    expect(better).not_to_have_count(0)
    expect(page).to_have_url(re.compile("segments=like"))
    first = page.get_by_role("combobox", name="two steps")
    expect(first.locator("option:checked")).to_have_text("2: PID, 1.00 m, 00:12 – 00:32")
    page.get_by_role("button", name="Align at their beginnings").click()
    expect(page.get_by_text("s since the beginning of the segment")).to_be_visible()

    first.select_option("1: PID, 0.50 m, 00:02 – 00:12")
    expect(unlike).to_contain_text("“two steps” holds 0.50 m, “late” holds 1.00 m.")
    expect(page).to_have_url(re.compile("segments=1%3A1,2%3A2"))
    page.go_back()
    expect(first.locator("option:checked")).to_have_text(re.compile("^2: "))
    expect(unlike).to_have_count(0)
