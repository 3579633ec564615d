"""A bookmark by a key; tests/browser has those that are set while driving."""

import re

from playwright.sync_api import Page, expect

from tests.browser.bookmarks import notes
from tests.browser.site import Site


def test_the_note_field_of_a_bookmark_closes_by_itself(page: Page, site: Site) -> None:
    session = site.api.post("/sessions", json={"name": "keys"}).raise_for_status().json()["id"]
    expect(page.get_by_role("button", name=re.compile("^REC"))).to_be_visible()
    page.keyboard.press("m")
    notice = page.get_by_role("region", name="Bookmark", exact=True)
    expect(notice).to_be_visible()
    expect(notice).to_be_hidden()
    assert notes(site, session) == [""]


def test_a_box_or_slider_that_has_the_focus_takes_no_letters(page: Page, site: Site) -> None:
    session = site.api.post("/sessions", json={"name": "keys"}).raise_for_status().json()["id"]
    expect(page.get_by_role("button", name=re.compile("^REC"))).to_be_visible()
    page.get_by_role("button", name="Page settings").click()
    page.get_by_role("checkbox", name="Single-key shortcuts").focus()
    page.keyboard.press("m")
    expect(page.get_by_role("region", name="Bookmark", exact=True)).to_be_visible()
    assert notes(site, session) == [""]
