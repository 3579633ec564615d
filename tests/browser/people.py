"""Other browsers of one robot, signed in by pairing links."""

from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, Page, expect

from tests.stack import Stack


def make_link(stack: Stack, role: str) -> str:
    """A link that signs one browser in."""
    made = stack.api.post("/access/codes", json={"role": role}).raise_for_status()
    return str(made.json()["link"])


@contextmanager
def somebody(browser: Browser, stack: Stack, role: str) -> Iterator[Page]:
    """The page in another browser, signed in by a link; console errors fail the test."""
    context = browser.new_context(viewport={"width": 1440, "height": 900}, color_scheme="dark")
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(make_link(stack, role))
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    yield page
    context.close()
    assert complaints == []
