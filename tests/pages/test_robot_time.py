"""Durations and times follow the robot's clock, even where the browser's is years off."""

import re
from datetime import datetime, timedelta

from playwright.sync_api import Browser, Page, expect

from tests.browser.people import somebody
from tests.browser.site import Site

AHEAD = datetime.now() + timedelta(days=9000, hours=7)
"""What the browser's calendar says."""
MINUTES = re.compile(r"\b0\d:\d\d\b")
"""A duration below ten minutes."""


def test_the_duration_of_a_recording_is_by_the_robot_s_clock(unopened: Page, site: Site) -> None:
    unopened.clock.install(time=AHEAD)
    session = site.api.post("/sessions", json={"name": "timed"}).raise_for_status().json()["id"]
    try:
        unopened.goto(site.first)
        recording = unopened.get_by_role("banner").get_by_role("button", name=re.compile("REC"))
        expect(recording).to_have_text(re.compile(r"REC\s*0\d:\d\d$"))
        unopened.get_by_role("link", name="Sessions").click()
        recording_now = unopened.get_by_role("region", name="Recording now")
        expect(recording_now.get_by_role("definition").first).to_have_text(MINUTES)
    finally:
        site.api.post(f"/sessions/{session}/stop").raise_for_status()


def test_the_validity_of_an_invitation_is_by_the_robot_s_clock(browser: Browser, site: Site) -> None:
    with somebody(browser, site, "operator") as page:
        page.clock.install(time=AHEAD)
        page.goto(f"{site.url}/#/people")
        page.reload()
        people = page.get_by_role("region", name="Invite")
        people.get_by_role("button", name="Create link").click()
        expect(people.get_by_text(re.compile(r"valid for (10:00|09:\d\d)"))).to_be_visible()


def test_the_clock_shows_the_robots_time(unopened: Page, site: Site) -> None:
    unopened.clock.install(time=AHEAD)
    unopened.goto(site.first)
    now = datetime.now()
    minutes = "|".join(f"{moment:%H:%M}" for moment in (now, now + timedelta(minutes=1)))
    expect(unopened.get_by_title("Robot’s clock")).to_have_text(re.compile(f"^({minutes})"))
