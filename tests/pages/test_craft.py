"""The craft's view: sessions to fit and to check; tests/server/features/identification fits them."""

import re

from playwright.sync_api import Page, expect

from tests.browser.pages import SESSIONS, fill
from tests.browser.site import Site

FITTED_MS = 30_000
"""The fit's process loads SciPy first, beside all other tests."""


def test_sessions_that_show_nothing_are_refused_in_words(page: Page, site: Site) -> None:
    fill(site)
    page.goto(f"{site.url}/#/tune/craft")
    fit = page.get_by_role("button", name="Fit the craft")
    expect(fit).to_be_disabled()
    expect(page.get_by_role("region", name="Craft in use")).to_contain_text("Default craft")
    first, second = (page.get_by_role("row", name=re.compile(name)).first for name in SESSIONS)
    first.get_by_role("checkbox").check()
    # A session is fitted or checks, never both.
    first.get_by_role("radio").check()
    expect(first.get_by_role("checkbox")).not_to_be_checked()
    expect(fit).to_be_disabled()
    second.get_by_role("checkbox").check()
    fit.click()
    expect(page.get_by_role("alert").filter(has_text="The last fit has no result")).to_contain_text(
        "No part of these sessions can be used: it takes depth, IMU and fins without a gap for 8 s",
        timeout=FITTED_MS,
    )
    width = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert width == 0
