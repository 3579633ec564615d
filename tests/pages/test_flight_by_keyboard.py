"""The whole flight by keyboard alone, by accessible names; axe finds nothing serious in either theme."""

import time

import pytest
from playwright.sync_api import Browser, Page, StorageState, expect

from tests.browser.axe import faults_in_both_themes
from tests.browser.by_keyboard import press_by_keyboard
from tests.browser.opening import DESKTOP
from tests.pages.dive_site import DiveSite
from tests.pages.test_capture import picture
from tests.pages.test_flight import opened
from tests.server.waiting import SECONDS


def wait_for_surge(page: Page, site: DiveSite) -> None:
    """Wait until the robot is told to swim forwards."""
    end = time.monotonic() + SECONDS
    while not site.driven or site.driven[-1]["axes"][0] <= 0:
        assert time.monotonic() < end, site.driven[-1:]
        page.wait_for_timeout(20)


@pytest.mark.usefixtures("_at_rest")
def test_a_flight_by_keyboard_alone(browser: Browser, site: DiveSite, cookies: StorageState) -> None:
    page, flown = opened(browser, site, cookies, DESKTOP)
    site.api.post("/sessions", json={"name": "by keyboard"}).raise_for_status()
    page.keyboard.press("f")
    expect(page.get_by_role("heading", name="Flight view")).to_be_attached()
    flown.show()
    press_by_keyboard(page, page.get_by_role("button", name="Swap: show the model large"))
    expect(page.get_by_role("img", name="The robot: roll")).to_be_visible()
    press_by_keyboard(page, page.get_by_role("button", name="Swap: show the camera large"))
    expect(page.get_by_role("img", name="Camera")).to_be_visible()

    press_by_keyboard(page, page.get_by_role("button", name="Controls", exact=True))
    press_by_keyboard(page, page.get_by_role("button", name="Manual", exact=True))
    press_by_keyboard(page, page.get_by_role("button", name="Hold to arm"))
    with page.expect_response("**/commands/arm"):
        press_by_keyboard(page, page.get_by_role("button", name="Press again to arm"))
    flown.mode = "manual"
    expect(page.get_by_role("group", name="Keys").first).to_be_visible()
    page.keyboard.down("w")
    wait_for_surge(page, site)
    page.keyboard.up("w")
    press_by_keyboard(page, page.get_by_role("button", name="Close Controls"))
    assert faults_in_both_themes(page) == []

    site.show(picture())
    press_by_keyboard(page, page.get_by_role("button", name="Snapshot", exact=True))
    expect(page.get_by_role("status").filter(has_text="Snapshot kept at")).to_be_visible()
    flown.alarms = [{}]
    alarm = page.get_by_role("group", name="Alarms")
    with page.expect_response("**/commands/acknowledge"):
        press_by_keyboard(page, alarm.get_by_role("button", name="Acknowledge"))
    assert faults_in_both_themes(page) == []
    press_by_keyboard(page, page.get_by_role("link", name="Leave"))
    expect(page.get_by_role("heading", name="Operate")).to_be_attached()
    page.context.close()
