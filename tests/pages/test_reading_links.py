"""A reading link: made beside a session, opened in a browser that is not signed in, ended by a press."""

import re

from playwright.sync_api import Browser, Page, expect

from tests.browser.opening import PHONE
from tests.browser.site import Site


def test_a_link_shows_its_session_to_who_is_not_signed_in_until_it_is_ended(
    page: Page, browser: Browser, site: Site
) -> None:
    session = site.api.post("/sessions", json={"name": "lent to a colleague"}).json()["id"]
    site.api.post(f"/sessions/{session}/stop").raise_for_status()
    page.goto(f"{site.url}/#/sessions/{session}")
    expect(page.get_by_role("heading", name="lent to a colleague")).to_be_visible()
    page.get_by_role("button", name="Page settings").click()
    page.get_by_label("Ends", exact=True).select_option("in 1 day")
    page.get_by_role("button", name="Make reading link").click()
    link = page.get_by_label("Reading link", exact=True).input_value()
    with browser.new_context(viewport=PHONE) as context:
        reader = context.new_page()
        sockets: list[object] = []
        reader.on("websocket", lambda socket: sockets.append(socket))
        reader.goto(link)
        expect(reader.get_by_text(re.compile(f"You are reading session {session} until"))).to_be_visible()
        expect(reader.get_by_role("heading", name="lent to a colleague")).to_be_visible()
        assert "read=" not in reader.url
        # A flag of the dive may have these letters in it, too: "robot.toml was edited".
        expect(reader.get_by_role("button", name=re.compile("^Edit"))).to_have_count(0)
        expect(reader.get_by_role("button", name="STOP")).to_have_count(0)
        reader.get_by_role("link", name="Replay", exact=True).click()
        expect(reader.get_by_role("heading", name=re.compile("^Replay"))).to_be_visible()
        reader.goto(f"{site.url}/#/sessions")
        expect(reader.get_by_role("heading", name="Not in this link")).to_be_visible()
        assert sockets == []
        page.get_by_role("button", name=re.compile("^End the link")).click()
        expect(page.get_by_role("button", name=re.compile("^End the link"))).to_have_count(0)
        reader.goto("about:blank")
        reader.goto(link)
        expect(reader.get_by_role("alert").filter(has_text="was ended")).to_be_visible()
