"""Addresses of the page: one that does not exist is reported, with a link back."""

from playwright.sync_api import Page, expect

from tests.browser.site import Site


def test_an_unknown_address_is_not_found(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/seesions/7")
    expect(page.get_by_role("heading", name="Page not found")).to_be_visible()
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    page.get_by_role("link", name="Go to Operate").click()
    expect(page.get_by_role("heading", name="Operate")).to_be_attached()
