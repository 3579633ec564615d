"""The first start: the printed link, opened in a new browser."""

import re

from playwright.sync_api import Browser, expect

from tests.browser.people import follow
from tests.stack import Stack

LINK = re.compile(r"http://localhost:\d+/#pair=\S+")


def test_the_printed_link_signs_a_browser_in_without_typing(browser: Browser, stack: Stack) -> None:
    (link,) = LINK.findall(stack.log.read_text())
    context = browser.new_context()
    page = context.new_page()
    follow(page, link)
    expect(page.get_by_role("link", name="Operate")).to_be_visible()
    assert "pair" not in page.url
    assert page.evaluate("document.cookie") == ""
    page.reload()
    expect(page.get_by_role("link", name="Operate")).to_be_visible()
    # The link is valid once: another browser is asked for a code.
    stranger = browser.new_context()
    other = stranger.new_page()
    follow(other, link)
    expect(other.get_by_text("This code is not valid")).to_be_visible()
    expect(other.get_by_role("link", name="Operate")).to_have_count(0)
    context.close()
    stranger.close()
