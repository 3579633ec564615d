"""Arranges the panels of Operate."""

import re

from playwright.sync_api import Locator, Page, expect


def arrange(page: Page) -> Locator:
    """Begin to arrange; return the bar of it."""
    page.get_by_role("button", name="Arrange", exact=True).click()
    bar = page.get_by_role("region", name="Arrange the panels")
    expect(bar).to_be_visible()
    return bar


def handle(page: Page, title: str) -> Locator:
    """Return the handle of the panel with this title."""
    return page.get_by_role("application", name=re.compile(f"^{title}: "))


def add(page: Page, bar: Locator, title: str) -> None:
    """Add a panel."""
    bar.get_by_role("button", name="Add a panel").click()
    bar.get_by_role("button", name=re.compile(f"^{title}")).click()
    expect(handle(page, title)).to_be_focused()
