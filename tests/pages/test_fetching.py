"""Parts of the page that are loaded on demand, and failures of that."""

from playwright.sync_api import Page, expect


def test_a_failed_download_of_a_part_of_the_page_is_reported(page: Page) -> None:
    page.route("**/assets/System-*.js", lambda route: route.abort())
    page.get_by_role("navigation", name="Pages").get_by_role("link", name="System").click()
    status = page.get_by_role("alert").filter(has_text="could not be loaded")
    expect(status).to_be_visible()
    page.unroute("**/assets/System-*.js")
    status.get_by_role("button", name="Try again").click()
    expect(page.get_by_role("heading", name="System")).to_be_visible()
