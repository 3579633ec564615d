"""The list of scenarios; tests/browser runs them."""

import re

from playwright.sync_api import Page, Route, expect

from server.features.scenarios.library import _shipped
from server.platform.settings import DataFolder
from tests.browser.scenarios import open_scenarios
from tests.pages.dive_site import DiveSite


def test_the_shipped_scenarios_are_shown_with_their_events(any_page: Page) -> None:
    open_scenarios(any_page)
    expect(any_page.get_by_role("radio")).to_have_count(8)
    expect(any_page.get_by_role("radio", name="In simulation")).to_be_checked()
    expect(any_page.get_by_role("radio", name=re.compile("Figure 14"))).to_be_checked()
    happens = any_page.get_by_role("list", name="Events").get_by_role("listitem")
    expect(happens).to_have_count(5)
    any_page.get_by_role("radio", name=re.compile("The link is lost")).check()
    expect(happens).to_have_count(12)
    expect(happens.nth(5)).to_contain_text("Line to the board cut")
    width = any_page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert width == 0


def test_a_check_that_is_refused_for_now_is_asked_again(page: Page) -> None:
    asked: list[Route] = []

    def answer(route: Route) -> None:
        asked.append(route)
        if len(asked) == 1:
            route.fulfill(status=429, json={"detail": "Several long requests are under way already."})
        else:
            route.continue_()

    page.route("**/api/scenarios/check", answer)
    open_scenarios(page)
    expect(page.get_by_text("Several long requests are under way already.")).to_have_count(0)
    assert len(asked) == 2


def test_an_edited_scenario_stays_in_the_list_until_it_is_saved(page: Page, site: DiveSite) -> None:
    open_scenarios(page)
    text = _shipped()["figure_14"].replace('"figure_14"', '"mine"', 1)
    page.get_by_role("button", name="Edit", exact=True).click()
    page.get_by_label("Scenario as TOML").fill(text)
    edited = page.get_by_role("radio", name=re.compile("^Edited"))
    expect(edited).to_be_checked()
    page.get_by_role("radio", name=re.compile("The link is lost")).check()
    page.get_by_role("link", name="Sessions", exact=True).click()
    expect(page.get_by_role("heading", name="Sessions", exact=True)).to_be_visible()
    page.get_by_role("link", name="Scenarios", exact=True).click()
    edited.check()
    page.get_by_role("button", name="Edit", exact=True).click()
    expect(page.get_by_label("Scenario as TOML")).to_have_value(text)
    try:
        page.get_by_role("button", name="Save as mine").click()
        expect(page.get_by_role("radio", name=re.compile("your own"))).to_be_checked()
        expect(edited).to_have_count(0)
    finally:
        (DataFolder(site.data).scenarios / "mine.toml").unlink(missing_ok=True)


def test_the_run_after_a_cancelled_one_can_be_cancelled(page: Page, site: DiveSite) -> None:
    text = _shipped()["figure_14"].replace("duration = ", "duration = 3600 # ", 1)
    open_scenarios(page)
    start = {"text": text, "place": "simulated"}
    first, _ = (site.api.post("/scenarios/runs", json=start).json()["run"] for _ in range(2))
    page.route("**/api/scenarios/cancel", lambda route: route.fulfill(status=204))
    try:
        page.get_by_role("button", name="Cancel this run and the queue").click()
        expect(page.get_by_role("button", name="Cancelling…")).to_be_disabled()
        site.api.post(f"/scenarios/cancel?run={first}").raise_for_status()
        expect(page.get_by_role("button", name="Cancel", exact=True)).to_be_enabled()
    finally:
        site.api.post("/scenarios/cancel").raise_for_status()
