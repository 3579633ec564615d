"""The views of the page Tune that need no robot."""

from playwright.sync_api import Page, expect

from tests.pages.dive_site import DiveSite


def test_the_address_of_the_step_response_names_its_loop(page: Page, site: DiveSite) -> None:
    page.goto(f"{site.url}/#/tune/response/heading")
    expect(page.get_by_role("heading", name="Heading after the step")).to_be_visible()
    page.goto(f"{site.url}/#/tune/response")
    page.reload()
    expect(page.get_by_role("heading", name="Depth after the step")).to_be_visible()
