"""The page while it opens."""

import json

from playwright.sync_api import Page, WebSocketRoute, expect

from tests.pages.dive_site import DiveSite

BEFORE_MS, AFTER_MS = 1500, 1000
"""Shorter than the page's patience; together longer."""


def test_a_page_without_data_waits_before_it_says_so(page: Page, site: DiveSite) -> None:
    """A bar that came and went with each opening would move buttons away from the pointer."""
    heard: list[str] = []

    def without_data(socket: WebSocketRoute) -> None:
        def hand_on(message: str | bytes) -> None:
            if isinstance(message, str):
                heard.append(json.loads(message)["op"])
                socket.send(message)

        socket.connect_to_server().on_message(hand_on)

    page.goto("about:blank")
    page.clock.install(time=0)
    page.clock.pause_at(1)
    page.route_web_socket("**/api/live", without_data)
    page.goto(site.url)
    while "health" not in heard:
        page.wait_for_timeout(10)
    bar = page.get_by_role("region", name="Connection lost")
    page.clock.run_for(BEFORE_MS)
    expect(bar).to_have_count(0)
    page.clock.run_for(AFTER_MS)
    expect(bar).to_contain_text("The runtime does not answer the server")
