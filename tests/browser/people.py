"""Other browsers of one robot, signed in by pairing links."""

from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, Page, expect

from tests.browser.chromium import DIVED
from tests.browser.site import Site


def make_link(site: Site, role: str) -> str:
    """Return a link that signs one browser in."""
    made = site.api.post("/access/codes", json={"role": role}).raise_for_status()
    # At the address that the tests open, where the link of a shell has the name that a start prints.
    return f"{site.url}/#pair={made.json()['code']}"


def follow(page: Page, link: str, name: str = "") -> None:
    """Sign in by a link, under the browser's own name where no other is given."""
    page.goto(link)
    if name:
        page.get_by_label("Name of this browser").fill(name)
    page.get_by_role("button", name="Sign in").click()


@contextmanager
def somebody(browser: Browser, site: Site, role: str) -> Iterator[Page]:
    """The page in another browser, signed in by a link; console errors fail the test."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, color_scheme="dark")
    context.add_init_script(DIVED)
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    follow(page, make_link(site, role))
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    yield page
    context.close()
    assert complaints == []
