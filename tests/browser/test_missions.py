"""Missions on the emulated robot: started from the page by a hold, watched, and ended."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.stack import Stack
from tests.waiting import wait_for

# It swims until the page has been looked at: what it says meanwhile goes away at the end.
MISSION = """format = 1
name = "from_the_page"
title = "From the page"

[mission]
do = "sequence"
steps = [
  { do = "swim", x = 0.3, seconds = 6 },
  { do = "surface" },
]
"""


def open_mission(page: Page, stack: Stack) -> None:
    """Store the mission and open it."""
    stack.api.post("/missions", json={"text": MISSION}).raise_for_status()
    page.goto(f"{stack.url}/#/missions/edit/from_the_page")
    expect(page.get_by_role("heading", level=1, name="From the page")).to_be_visible()


def hold_to_start(page: Page) -> None:
    """Start it as a person does."""
    hold = page.get_by_role("button", name="Hold to start the mission")
    expect(hold).to_be_enabled()
    hold.hover()
    page.mouse.down()
    expect(page.get_by_text("From the page has begun.")).to_be_visible()
    page.mouse.up()


@pytest.fixture
def robot_at_rest(stack: Stack) -> None:
    stack.api.post("/robot/stop").raise_for_status()


@pytest.mark.usefixtures("robot_at_rest")
def test_a_mission_is_started_by_a_hold_and_ends_disarmed(page: Page, stack: Stack) -> None:
    open_mission(page, stack)
    before = (stack.api.get("/missions/state").json() or {"number": 0})["number"]
    hold_to_start(page)
    bar = page.get_by_role("banner")
    expect(bar.get_by_text(re.compile("^ARMED"))).to_be_visible()
    # While it runs no other begins, and the page says why.
    expect(page.get_by_role("button", name="Hold to start the mission")).to_be_disabled()
    expect(page.get_by_text("The robot is armed already.")).to_be_visible()

    def ended() -> bool:
        state = stack.api.get("/missions/state").json()
        return state["number"] > before and state["phase"] not in ("running", "paused")

    wait_for(ended, "the mission to end")
    state = stack.api.get("/missions/state").json()
    assert (state["phase"], state["name"]) == ("succeeded", "from_the_page")
    assert [step["status"] for step in state["steps"]] == ["done", "done", "done"]
    expect(bar.get_by_text("Disarmed")).to_be_visible()
    expect(page.get_by_role("button", name="Hold to start the mission")).to_be_enabled()
