"""Numbers as people type them, in browsers of several languages."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.pages import SESSIONS, fill
from tests.pages.dive_site import DiveSite


@pytest.fixture(params=["en-US", "de-DE"])
def page(request: pytest.FixtureRequest, browser: Browser, cookies: object) -> Iterator[Page]:
    context = browser.new_context(locale=request.param, storage_state=cookies)  # type: ignore[arg-type]
    yield context.new_page()
    context.close()


def test_an_export_says_why_it_refuses_a_range(page: Page, site: DiveSite) -> None:
    fill(site)
    numbers = {session["name"]: session["id"] for session in site.api.get("/sessions").json()}
    page.goto(f"{site.url}/#/sessions/{numbers[SESSIONS[0]]}/data")
    form = page.get_by_role("region", name="Export")
    create = form.get_by_role("button", name="Create file")
    start, end = form.get_by_label("From"), form.get_by_label("To", exact=True)
    start.fill("−5")
    expect(form.get_by_text(re.compile(r"^-5 is outside of 0 to \d+ s\.$"))).to_be_visible()
    expect(create).to_be_disabled()
    expect(create).to_have_accessible_description("Correct the marked numbers first.")
    start.fill("0,5 s")
    end.fill("99999")
    expect(form.get_by_text(re.compile(r"^99999 is outside of 0 to \d+ s\.$"))).to_be_visible()
    end.fill("0.25")
    expect(form.get_by_text("The end, 0.25 s, must be after the start, 0.5 s.")).to_be_visible()
    expect(create).to_be_disabled()
    end.fill("")
    expect(create).to_be_enabled()
    create.click()
    expect(form.get_by_text("The same file is already in the list below.")).to_be_visible()
    form.get_by_role("button", name="Delete").click()
    expect(form.get_by_role("link", name="Download")).to_have_count(0)


def test_a_range_that_ends_before_it_starts_is_not_put_back(page: Page, site: DiveSite) -> None:
    fill(site)
    numbers = {session["name"]: session["id"] for session in site.api.get("/sessions").json()}
    page.goto(f"{site.url}/#/sessions/compare/{numbers[SESSIONS[0]]}")
    group = page.get_by_role("group", name="Time range")
    start, end = group.get_by_label("From", exact=True), group.get_by_label("to", exact=True)
    start.fill("0,5 s")
    start.press("Enter")
    expect(start).to_have_value("0.5")
    end.fill("0.2")
    end.press("Enter")
    expect(end).to_have_value("0.2")
    expect(group.get_by_text("The end, 0.2 s, must be after the start, 0.5 s.")).to_be_visible()
    end.fill("1,234")
    end.press("Enter")
    expect(end).to_have_value("1,234")
    expect(group.get_by_text("“1,234” can be 1.234 or 1234: enter one of these.")).to_be_visible()
    end.fill("1.5")
    end.press("Enter")
    expect(group.locator(".problem")).to_be_hidden()
