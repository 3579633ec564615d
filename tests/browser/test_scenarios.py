"""Scenarios: written, checked, run live, watched, and found as sessions."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser.code import write_code
from tests.browser.scenarios import open_scenarios
from tests.stack import Stack

TEXT = """
name = "from_the_page"
title = "From the page"
duration = 3
[scene]
kind = "natural"
depth = 3.0
[[events]]
at = 0.2
do = "arm"
[[events]]
at = 2
do = "card"
colour = "yellow"
"""


def hold_to_run(page: Page) -> None:
    """Run the scenario on the running robot, as a person does."""
    page.get_by_role("radio", name="On the robot, live").check()
    hold = page.get_by_role("button", name="Hold to run live")
    expect(hold).to_be_enabled()
    hold.hover()
    page.mouse.down()
    expect(page.get_by_role("region", name="Running")).to_be_visible()
    page.mouse.up()


@pytest.fixture
def robot_at_rest(stack: Stack) -> None:
    stack.api.post("/scenarios/cancel").raise_for_status()


@pytest.mark.usefixtures("robot_at_rest")
def test_a_scenario_is_written_run_and_found_as_a_session(page: Page, stack: Stack) -> None:
    open_scenarios(page)
    page.get_by_role("button", name="Edit").click()
    text = page.get_by_role("textbox", name="Scenario as TOML")
    write_code(text, TEXT.replace("depth = 3.0", "deep = 3.0"))
    expect(page.get_by_text("scene: depth is missing")).to_be_visible()
    expect(page.get_by_role("button", name="Run in simulation")).to_be_disabled()
    write_code(text, TEXT)
    expect(page.get_by_text("The scenario is valid.")).to_be_visible()
    hold_to_run(page)

    ended = page.get_by_role("region", name="Last run")
    expect(ended.get_by_text("complete", exact=True)).to_be_visible()
    session = stack.api.get("/sessions").json()[0]
    assert session["name"] == "From the page"
    expect(ended.get_by_role("link", name="Session")).to_have_attribute("href", f"#/sessions/{session['id']}")


@pytest.mark.usefixtures("robot_at_rest")
def test_stop_ends_a_scenario(page: Page) -> None:
    open_scenarios(page)
    page.get_by_role("button", name="Edit").click()
    text = page.get_by_role("textbox", name="Scenario as TOML")
    write_code(text, TEXT.replace("duration = 3", "duration = 300").replace("at = 2\n", "at = 200\n"))
    expect(page.get_by_text("The scenario is valid.")).to_be_visible()
    hold_to_run(page)
    running = page.get_by_role("region", name="Running")
    expect(running.get_by_role("heading", name="From the page")).to_be_visible()
    expect(running.get_by_role("progressbar")).to_have_attribute("aria-valuemax", "300")
    expect(running.get_by_text("Yellow card")).to_be_visible()
    armed = page.get_by_role("banner").get_by_text(re.compile("^ARMED"))
    expect(armed).to_be_visible()
    page.keyboard.press("Escape")
    ended = page.get_by_role("region", name="Last run")
    expect(ended.get_by_text("STOP was pressed.")).to_be_visible()
    expect(ended.get_by_text("cancelled", exact=True)).to_be_visible()


@pytest.mark.usefixtures("robot_at_rest")
def test_one_click_does_not_run_a_scenario_live(page: Page) -> None:
    open_scenarios(page)
    page.get_by_role("radio", name="On the robot, live").check()
    hold = page.get_by_role("button", name="Hold to run live")
    hold.click()
    expect(hold).to_be_visible()
    expect(page.get_by_role("region", name="Running")).to_have_count(0)
    hold.press("Enter")
    expect(page.get_by_role("button", name="Press again to run live")).to_be_visible()
