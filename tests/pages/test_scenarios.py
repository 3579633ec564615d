"""The list of scenarios; tests/browser runs them."""

import re
import tomllib

from playwright.sync_api import Page, Route, expect

from robot_runtime.experiments.scenario.library import SHIPPED, shipped_scenarios
from server.platform.settings import DataFolder
from tests.browser.code import draft_of, write_code
from tests.browser.scenarios import open_scenarios
from tests.pages.dive_site import DiveSite


def test_the_shipped_scenarios_are_shown_with_their_events(any_page: Page) -> None:
    open_scenarios(any_page)
    # And two places to run them.
    expect(any_page.get_by_role("radio")).to_have_count(len(SHIPPED) + 2)
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
    text = shipped_scenarios()["figure_14"].replace('"figure_14"', '"mine"', 1)
    page.get_by_role("button", name="Edit", exact=True).click()
    write_code(page.get_by_role("textbox", name="Scenario as TOML"), text)
    edited = page.get_by_role("radio", name=re.compile("^Edited"))
    expect(edited).to_be_checked()
    page.get_by_role("radio", name=re.compile("The link is lost")).check()
    page.get_by_role("link", name="Sessions", exact=True).click()
    expect(page.get_by_role("heading", name="Sessions", exact=True)).to_be_visible()
    page.get_by_role("link", name="Scenarios", exact=True).click()
    edited.check()
    page.get_by_role("button", name="Edit", exact=True).click()
    expect(page.get_by_role("textbox", name="Scenario as TOML")).to_contain_text('name = "mine"')
    assert draft_of(page, "mucat-scenario") == text
    try:
        page.get_by_role("button", name="Save as mine").click()
        expect(page.get_by_role("radio", name=re.compile("your own"))).to_be_checked()
        expect(edited).to_have_count(0)
    finally:
        (DataFolder(site.data).scenarios / "mine.toml").unlink(missing_ok=True)


def test_an_untouched_scenario_follows_the_library_and_leaves_no_draft(page: Page, site: DiveSite) -> None:
    text = shipped_scenarios()["figure_14"].replace('"figure_14"', '"theirs"', 1)
    later = text.replace("duration = 60", "duration = 61")
    site.api.post("/scenarios", json={"text": text}).raise_for_status()
    try:
        open_scenarios(page)
        theirs = page.get_by_role("radio", name=re.compile("your own"))
        theirs.check()
        page.get_by_role("button", name="Edit", exact=True).click()
        box = page.get_by_role("textbox", name="Scenario as TOML")
        expect(box).to_contain_text('name = "theirs"')
        page.get_by_role("link", name="Sessions", exact=True).click()
        expect(page.get_by_role("heading", name="Sessions", exact=True)).to_be_visible()
        site.api.post("/scenarios", json={"text": later}).raise_for_status()
        page.get_by_role("link", name="Scenarios", exact=True).click()
        expect(theirs).to_be_checked()
        edited = page.get_by_role("radio", name=re.compile("^Edited"))
        expect(edited).to_have_count(0)
        page.get_by_role("button", name="Edit", exact=True).click()
        expect(box).to_contain_text("duration = 61")
        # What is taken back is no draft either.
        box.focus()
        page.keyboard.press("Control+End")
        page.keyboard.type("#")
        expect(edited).to_be_checked()
        page.keyboard.press("Backspace")
        expect(theirs).to_be_checked()
        expect(edited).to_have_count(0)
    finally:
        (DataFolder(site.data).scenarios / "theirs.toml").unlink(missing_ok=True)


def test_the_run_after_a_cancelled_one_can_be_cancelled(page: Page, site: DiveSite) -> None:
    text = shipped_scenarios()["figure_14"].replace("duration = ", "duration = 3600 # ", 1)
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


def test_an_event_is_moved_edited_added_and_deleted_and_the_text_keeps_its_comments(page: Page) -> None:
    open_scenarios(page)
    page.get_by_role("button", name="Edit", exact=True).click()
    before = shipped_scenarios()["figure_14"]
    box = page.get_by_role("textbox", name="Scenario as TOML")
    expect(box).to_be_visible()
    card = page.get_by_role("slider", name="card yellow").first
    # By mouse: three quarters of the line are 45 s.
    arm, stop = page.get_by_role("slider", name="arm"), page.get_by_role("slider", name="stop")
    left, right = arm.bounding_box(), stop.bounding_box()
    assert left is not None
    assert right is not None
    card.hover()
    page.mouse.down()
    end = left["x"] + (right["x"] - left["x"]) * 21 / 59 + left["width"] / 2
    page.mouse.move(end, left["y"] + left["height"] / 2, steps=4)
    page.mouse.up()
    expect(card).to_have_attribute("aria-valuetext", re.compile(r"^2[12](\.\d)? s"))
    # By keys, and by its fields.
    card.press("ArrowRight")
    card.press("ArrowDown")
    away = page.get_by_role("slider", name="card", exact=True)
    expect(away).to_be_focused()
    page.get_by_label("at", exact=True).fill("31")
    page.get_by_label("at", exact=True).press("Enter")
    page.get_by_label("colour").select_option("red")
    away = page.get_by_role("slider", name="card red")
    expect(away).to_have_attribute("aria-valuenow", "31")
    page.get_by_label("New event").select_option("current")
    page.get_by_role("button", name="Add", exact=True).click()
    page.get_by_label("north").fill("0,1")
    page.get_by_label("north").press("Enter")
    expect(page.get_by_role("slider", name="current 0.1")).to_be_visible()
    stop.press("Delete")
    expect(stop).to_have_count(0)
    text = draft_of(page, "mucat-scenario")
    assert text.startswith(before[: before.index("[[events]]")])
    events = tomllib.loads(text)["events"]
    assert [event["do"] for event in events] == ["arm", "card", "card", "card", "current"]
    assert events[2] == {"at": 31, "do": "card", "colour": "red"}
    assert events[4]["north"] == 0.1

    # A text that is no TOML leaves the last events, and the problem stands in its line.
    write_code(box, text.replace("duration = 60", "duration ="))
    expect(page.get_by_text("The text is no TOML now.")).to_be_visible()
    expect(page.get_by_role("slider", name="card red")).to_have_attribute("aria-readonly", "true")
    page.get_by_role("button", name="Line 8").click()
    expect(box).to_be_focused()
    page.keyboard.press("Tab")
    expect(box).not_to_be_focused()
    box.focus()
    page.keyboard.press("Shift+Tab")
    expect(box).not_to_be_focused()


def test_a_scenario_lists_its_runs(page: Page, site: DiveSite) -> None:
    text = (
        shipped_scenarios()["figure_14"]
        .replace("duration = 60", "duration = 5")
        .replace('"figure_14"', '"brief"')
    )
    text = text[: text.index("[[events]]")]
    site.api.post("/scenarios/runs", json={"text": text, "place": "simulated"}).raise_for_status()
    open_scenarios(page)
    expect(page.get_by_role("heading", name="Last run")).to_be_visible()
    page.get_by_role("button", name="Edit", exact=True).click()
    write_code(page.get_by_role("textbox", name="Scenario as TOML"), text)
    runs = page.get_by_role("region", name="Runs of")
    expect(runs.get_by_role("listitem")).to_have_count(1)
    expect(runs.locator("polyline")).to_have_attribute("points", re.compile(r"\d"))
    runs.get_by_role("link").click()
    expect(page).to_have_url(re.compile("#/sessions/"))
