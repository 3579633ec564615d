"""Addresses of sessions that are not there: the page says so."""

from playwright.sync_api import Page, expect

from tests.browser.site import Site


def test_an_address_without_sessions_shows_the_remedy(any_page: Page, site: Site) -> None:
    any_page.goto(f"{site.url}/#/sessions/compare/")
    expect(any_page.get_by_text("No session selected")).to_be_visible()
    any_page.goto(f"{site.url}/#/sessions/compare/999999")
    expect(
        any_page.get_by_text("There is no session 999999; choose one from the list of sessions.")
    ).to_be_visible()
    wider = "document.querySelector('main').scrollWidth - document.querySelector('main').clientWidth"
    assert any_page.evaluate(wider) == 0


def test_a_replay_of_a_missing_session_leads_to_those_that_are_there(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/replay/999999")
    problem = page.get_by_role("alert")
    expect(problem.get_by_text("There is no session 999999")).to_be_visible()
    problem.get_by_role("link", name="Go to Sessions").click()
    expect(page.get_by_role("heading", name="Sessions", level=1)).to_be_visible()
