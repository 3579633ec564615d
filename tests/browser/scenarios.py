"""The page of the scenarios."""

from playwright.sync_api import Page, expect


def open_scenarios(page: Page) -> None:
    page.get_by_role("link", name="Scenarios", exact=True).click()
    expect(page.get_by_role("button", name="Run in simulation")).to_be_enabled()
