"""Goes to controls of a page by Tab alone, for tests of both rooms."""

from playwright.sync_api import Locator, Page, expect

STOPS = 80
"""Presses of Tab that lead past everything on the page."""


def press_by_keyboard(page: Page, control: Locator, key: str = "Enter") -> None:
    """Go to a control by Tab alone, and press the key there."""
    expect(control).to_be_visible()
    for _ in range(STOPS):
        if control.evaluate("(one) => one === document.activeElement"):
            page.keyboard.press(key)
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"Tab does not reach {control}")
