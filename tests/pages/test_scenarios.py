"""The list of scenarios; tests/browser runs them."""

import re

from playwright.sync_api import Page, expect

from tests.browser.scenarios import open_scenarios


def test_the_shipped_scenarios_are_shown_with_their_events(any_page: Page) -> None:
    open_scenarios(any_page)
    expect(any_page.get_by_role("radio")).to_have_count(8)
    expect(any_page.get_by_role("radio", name="In simulation")).to_be_checked()
    expect(any_page.get_by_role("radio", name=re.compile("Figure 14"))).to_be_checked()
    happens = any_page.get_by_role("list", name="Events").get_by_role("listitem")
    expect(happens).to_have_count(5)
    any_page.get_by_role("radio", name=re.compile("The link is lost")).check()
    expect(happens).to_have_count(12)
    expect(happens.nth(5)).to_contain_text("Line to the board cut")
    width = any_page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert width == 0
