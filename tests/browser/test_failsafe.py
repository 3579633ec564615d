"""A fault: the robot stops, reports the reason, and can be armed only after an acknowledgement."""

import re

from playwright.sync_api import Page, expect

from tests.browser.driving import hold_to_arm
from tests.stack import Stack


def test_a_fault_is_shown_acknowledged_and_followed_by_arming(page: Page, stack: Stack) -> None:
    expect(page.get_by_role("button", name="0 alarms")).to_be_visible()
    hold_to_arm(page)
    board = stack.child("build/board")
    board.suspend()
    try:
        arm = page.get_by_role("region", name="Arm", exact=True)
        expect(arm).to_contain_text("Failsafe")
        expect(page.get_by_text("FAILSAFE", exact=True)).to_be_visible()
    finally:
        board.resume()
    alarms = page.get_by_role("button", name=re.compile("not acknowledged$"))
    alarms.click()
    expect(
        page.get_by_role("listitem").filter(has_text="The depth is too old for control.").first
    ).to_contain_text("What to do:")
    page.get_by_role("button", name="Close", exact=True).click()
    expect(page.get_by_label("Connection lost")).to_be_hidden()
    arm.get_by_role("button", name="Acknowledge").click()
    expect(page.get_by_text("FAILSAFE", exact=True)).to_be_hidden()
    hold_to_arm(page)
