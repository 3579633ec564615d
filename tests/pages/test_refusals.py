"""Controls and pages after the server has refused something, or answers late."""

import re

import pytest
from playwright.sync_api import Page, Route, expect

from tests.browser.site import Site

REFUSED = {"status": 503, "json": {"detail": "The disk is full."}}


def record(site: Site, name: str) -> int:
    """Return a short session of this name."""
    session: int = site.api.post("/sessions", json={"name": name}).raise_for_status().json()["id"]
    site.api.post(f"/sessions/{session}/stop").raise_for_status()
    return session


def test_a_refused_tick_is_taken_back(page: Page, site: Site) -> None:
    session = record(site, "refused tick")
    page.goto(f"{site.url}/#/sessions/{session}")
    tick = page.get_by_role("checkbox", name="Keep permanently")
    page.route(
        f"**/api/sessions/{session}",
        lambda route, asked: route.fulfill(**REFUSED) if asked.method == "PATCH" else route.continue_(),
    )
    tick.click()
    expect(page.get_by_text("The disk is full.")).to_be_visible()
    expect(tick).not_to_be_checked()


def test_a_refused_course_is_not_shown_as_chosen(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/operate")
    page.route("**/api/robot/commands/steering", lambda route: route.fulfill(**REFUSED))
    course = page.get_by_role("region", name="Course").get_by_role("combobox")
    before = course.input_value()
    course.select_option("beacons")
    expect(page.get_by_role("region", name="Course").get_by_role("alert")).to_contain_text(
        "The disk is full."
    )
    expect(course).to_have_value(before)


def test_try_again_clears_the_failure_of_a_deletion(page: Page, site: Site) -> None:
    session = record(site, "not deleted")
    page.goto(f"{site.url}/#/sessions")
    page.route(
        f"**/api/sessions/{session}",
        lambda route, asked: route.fulfill(**REFUSED) if asked.method == "DELETE" else route.continue_(),
    )
    page.get_by_role("button", name="Delete not deleted").click()
    failure = page.get_by_role("alert").filter(has_text="The disk is full.")
    expect(failure).to_be_visible()
    failure.get_by_role("button", name="Try again").click()
    expect(failure).to_be_hidden()


def test_a_test_that_starts_late_does_not_take_back_who_has_left(page: Page, site: Site) -> None:
    held: list[Route] = []
    page.route(
        "**/api/comm-tests/runs",
        lambda route, asked: held.append(route) if asked.method == "POST" else route.continue_(),
    )
    page.goto(f"{site.url}/#/comm-tests")
    page.get_by_role("button", name="Start the test").click()
    expect(page.get_by_role("button", name=re.compile("^Starting"))).to_be_visible()
    while not held:
        page.wait_for_timeout(10)  # the page says so before its question has come here
    page.get_by_role("link", name="Sessions").click()
    expect(page.get_by_role("heading", name="Sessions")).to_be_visible()
    with page.expect_response(lambda answer: answer.request.method == "POST"):
        held[0].fulfill(status=201, json={"run": 7})
    # Its answer has been used once the page has asked for something else, and got it.
    page.evaluate("() => fetch('/api/health').then((answer) => answer.text())")
    assert page.url.endswith("#/sessions")


def test_a_token_is_made_once_however_often_its_button_is_pressed(page: Page, site: Site) -> None:
    held: list[Route] = []
    page.route("**/api/access/tokens", lambda route: held.append(route))
    page.goto(f"{site.url}/#/people")
    form = page.get_by_role("region", name="Token for a program")
    form.get_by_role("textbox").fill("logger")
    create = form.get_by_role("button", name="Create token")
    with page.expect_request("**/api/access/tokens"):
        create.click()
    create.click()
    # What the second press would have asked for would come before this.
    page.evaluate("() => fetch('/api/health').then((answer) => answer.text())")
    assert len(held) == 1
    page.unroute_all(behavior="ignoreErrors")


@pytest.mark.usefixtures("_at_rest")
def test_a_report_can_be_made_while_it_records_and_an_archive_cannot(page: Page, site: Site) -> None:
    session = site.api.post("/sessions", json={"name": "goes on"}).raise_for_status().json()["id"]
    page.goto(f"{site.url}/#/sessions/{session}/data")
    form = page.get_by_role("region", name="Export")
    create = form.get_by_role("button", name="Create file")
    form.get_by_role("radio", name="Archive").check()
    expect(create).to_be_disabled()
    form.get_by_role("radio", name="Report").check()
    expect(create).to_be_enabled()
