"""The views of the page Tune that need no robot."""

import json
import re

from playwright.sync_api import Page, WebSocketRoute, expect

from tests.pages.dive_site import DiveSite


def test_the_address_of_the_step_response_names_its_loop(page: Page, site: DiveSite) -> None:
    page.goto(f"{site.url}/#/tune/response/heading")
    expect(page.get_by_role("heading", name="Heading after the step")).to_be_visible()
    page.goto(f"{site.url}/#/tune/response")
    page.reload()
    expect(page.get_by_role("heading", name="Depth after the step")).to_be_visible()


def test_the_runs_are_asked_for_once_when_one_has_ended(page: Page, site: DiveSite) -> None:
    sockets: list[WebSocketRoute] = []

    def join(socket: WebSocketRoute) -> None:
        socket.connect_to_server()
        sockets.append(socket)

    def asked_after(run: int) -> int:
        last = {"id": run, "kind": "step", "loop": "depth"}
        sockets[-1].send(json.dumps({"op": "tuning", "active": None, "last": last}))
        return int(page.evaluate("asked"))

    page.add_init_script("""
        window.asked = 0;
        const whole = window.fetch;
        window.fetch = (...args) => {
            if (new Request(...args).url.includes('/api/tuning/runs')) window.asked += 1;
            return whole(...args);
        };
    """)
    page.route_web_socket(re.compile("/api/live"), join)
    page.goto(f"{site.url}/#/tune/response")
    page.reload()
    expect(page.get_by_text("No step response yet")).to_be_visible()
    first = asked_after(7)
    assert first > 0
    # The server sends the last run with each report of the next one.
    assert [asked_after(run) - first for run in (7, 7, 8)] == [0, 0, 1]
