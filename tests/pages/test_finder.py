"""Ctrl+K finds and opens; ? lists the keys; Esc stays STOP."""

import re

from playwright.sync_api import Page, expect

from tests.browser.site import Site


def test_what_is_found_opens_by_keys_alone_and_esc_is_stop(page: Page, site: Site) -> None:
    session = site.api.post("/sessions", json={"name": "turtle under ice"}).json()["id"]
    site.api.post(f"/sessions/{session}/stop").raise_for_status()
    page.keyboard.press("Control+k")
    field = page.get_by_role("combobox", name="Page, session, action or help")
    expect(field).to_be_focused()
    page.keyboard.type("under ice")
    expect(page.get_by_role("option", name=re.compile("turtle under ice"))).to_be_visible()
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name="turtle under ice")).to_be_visible()
    page.keyboard.press("?")
    expect(page.get_by_role("heading", name="Keys")).to_be_visible()
    with page.expect_request("**/api/robot/stop"):
        page.keyboard.press("Escape")
    expect(page.get_by_role("heading", name="Keys")).to_be_visible()
    page.keyboard.press("?")
    expect(page.get_by_role("heading", name="Keys")).to_have_count(0)
