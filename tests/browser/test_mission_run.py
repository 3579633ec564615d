"""A mission on the page: it runs, somebody takes over and hands back, it ends, and it is replayed."""

import re
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, StorageState, expect

from tests.browser.axe import AXE, faults
from tests.browser.opening import PHONE, opened_page
from tests.stack import Stack

PANEL = "'section[aria-label=Mission]'"
TEXT = """
format = 1
name = "look"
title = "Look around"
pause = 60
[limits]
depth = 1.5
time = 200
[mission]
do = "sequence"
steps = [
  { do = "dive", depth = 0.3, within = 0.2, timeout = 30 },
  { do = "try", steps = [{ do = "wait_for", sees = "blue", timeout = 1, note = "a card" }] },
  { do = "hold", seconds = 60, within = 5 },
  { do = "hold", seconds = 1, within = 5 },
  { do = "surface" },
]
"""


def step(mission: Locator, path: str) -> Locator:
    """Return the row of a step."""
    return mission.locator(f'[data-path="{path}"]')


def begin(page: Page, stack: Stack) -> int:
    """Record, and begin the mission. Return the session."""
    control = page.get_by_role("button", name=re.compile("^Control:"))
    # A page that has just come takes control that is free, and would do so again.
    expect(control).to_have_accessible_name("Control: you have control")
    stack.calm()
    session: int = stack.api.post("/sessions", json={"name": "a mission"}).json()["id"]
    stack.api.post("/missions/start", json={"text": TEXT}, timeout=30.0).raise_for_status()
    control.click()
    page.get_by_role("button", name="Take control").click()
    expect(control).to_have_accessible_name("Control: you have control")
    return session


def test_it_is_watched_taken_over_handed_back_and_replayed(page: Page, stack: Stack) -> None:
    session = begin(page, stack)
    mission = page.get_by_role("region", name="Mission")
    expect(mission).to_contain_text("Look around")
    expect(step(mission, "3")).to_have_attribute("data-status", "running")
    expect(step(mission, "1")).to_have_attribute("data-status", "done")
    expect(step(mission, "2.1")).to_have_attribute("data-status", "failed")
    expect(step(mission, "2.1")).to_contain_text("It saw no blue for 1 s.")
    expect(step(mission, "4")).to_have_attribute("data-status", "waiting")
    expect(step(mission, "3")).to_contain_text(re.compile(r"\d+ / 60 s"))
    assert faults_in_both_themes(page) == []
    # Commands that a mission refuses are not offered meanwhile.
    expect(page.get_by_role("region", name="Set points")).to_have_count(0)

    page.get_by_role("button", name="Manual", exact=True).click()
    expect(mission).to_contain_text("Somebody steers by hand.")
    expect(mission).to_contain_text(re.compile(r"Pause left: \d+ s"))
    mission.get_by_role("button", name="Hand back").click()
    expect(mission.get_by_role("status")).to_have_text("Running")
    mission.get_by_role("button", name="Pause").click()
    expect(mission).to_contain_text("It was paused.")
    mission.get_by_role("button", name="Continue").click()
    expect(mission.get_by_role("status")).to_have_text("Running")
    mission.get_by_role("button", name="Skip step").click()
    expect(step(mission, "3")).to_contain_text("It was skipped.")
    expect(mission.get_by_role("status")).to_have_text("Succeeded")
    expect(mission.get_by_role("button")).to_have_count(0)
    expect(page.get_by_role("region", name="Set points")).to_be_visible()
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()

    (recorded,) = stack.api.get(f"/sessions/{session}/missions").json()
    assert recorded["document"] == TEXT
    check_session(page, stack, session)
    check_comparison(page, stack, session)
    check_replay(page, stack, session, {step["path"]: step["time"] for step in recorded["started"]})


def check_session(page: Page, stack: Stack, session: int) -> None:
    """The session's page has the mission's end, steps and text."""
    page.goto(f"{stack.url}/#/sessions/{session}")
    mission = page.get_by_role("region", name="Mission")
    expect(mission.get_by_role("status")).to_have_text("Succeeded")
    expect(step(mission, "5")).to_have_attribute("data-status", "done")
    mission.get_by_text("Mission (TOML)").click()
    expect(mission).to_contain_text('title = "Look around"')


def check_comparison(page: Page, stack: Stack, session: int) -> None:
    """A comparison can be aligned at the start of a step."""
    page.goto(f"{stack.url}/#/sessions/compare/{session}")
    page.get_by_label("Align at").select_option("Mission step")
    page.get_by_label("Mission step", exact=True).select_option("3 Hold the depth for 60 s")
    expect(page.get_by_text("s since the start of the mission’s step 3").first).to_be_visible()


def check_replay(page: Page, stack: Stack, session: int, started: dict[str, Any]) -> None:
    """Every moment of a replay has the steps as they were, also after a seek back."""
    moments = [(started["3"] + 0.5, "running", "3"), (started["5"] + 0.5, "done", "3")]
    for time, status, path in [*moments, (started["1"] + 0.2, "running", "1")]:
        page.goto(f"{stack.url}/#/replay/{session}/{time:.1f}")
        mission = page.get_by_role("region", name="Mission")
        expect(step(mission, path)).to_have_attribute("data-status", status)
        expect(mission.get_by_role("button")).to_have_count(0)
    expect(step(mission, "3")).to_have_attribute("data-status", "waiting")


@pytest.mark.usefixtures("_at_rest")
def test_a_phone_shows_the_steps_and_ends_the_mission(
    browser: Browser, stack: Stack, cookies: StorageState
) -> None:
    with opened_page(browser, stack, cookies, PHONE) as page:
        begin(page, stack)
        mission = page.get_by_role("region", name="Mission")
        expect(step(mission, "1")).to_have_attribute("data-status", re.compile("running|done"))
        assert faults_in_both_themes(page) == []
        end = mission.get_by_role("button", name="End")
        box = end.bounding_box()
        assert box is not None
        assert box["height"] >= 44
        end.click()
        expect(mission.get_by_role("status")).to_have_text("Ended")
        expect(mission).to_contain_text("An operator ended it.")
        expect(page.get_by_role("button", name="Hold to arm")).to_be_visible()


def faults_in_both_themes(page: Page) -> list[str]:
    """Violations of accessibility in the mission's panel, as axe-core finds them."""
    page.evaluate(AXE.read_text())
    dark = faults(page, f"{PANEL}, {{ resultTypes: ['violations'] }}")
    page.evaluate("document.documentElement.dataset.theme = 'sunlight'")
    return dark + faults(page, f"{PANEL}, {{ runOnly: ['color-contrast-enhanced'] }}")
