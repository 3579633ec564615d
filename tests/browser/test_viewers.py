"""Viewers: they watch and press STOP, and arm nothing."""

from playwright.sync_api import Browser, Page, expect

from tests.browser.driving import hold_to_arm
from tests.browser.people import somebody
from tests.stack import Stack


def test_a_viewer_stops_and_does_not_arm(page: Page, browser: Browser, stack: Stack) -> None:
    with somebody(browser, stack, "viewer") as viewer:
        arm = viewer.get_by_role("region", name="Arm", exact=True)
        expect(arm).to_contain_text("Viewers can watch and press STOP.")
        expect(arm.get_by_role("button", name="Hold to arm")).to_be_disabled()
        hold_to_arm(page)
        expect(arm).to_contain_text("Armed")
        viewer.get_by_role("button", name="STOP").click()
        expect(viewer.get_by_text("Disarmed", exact=True)).to_be_visible()
        expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
