"""Notes at the moments of a session: written, read, changed, deleted and found."""

import re

from playwright.sync_api import Page, expect

from tests.browser.bookmarks import notes
from tests.browser.site import Site

NOTE = """# Lost the bottom

- <img src=x onerror="document.title='html'">
- [press](javascript:alert(1))
- **cold**"""


def test_a_note_is_written_in_markdown_at_a_moment_and_found_again(page: Page, site: Site) -> None:
    session = site.api.post("/sessions", json={"name": "noted"}).raise_for_status().json()["id"]
    site.api.post(f"/sessions/{session}/markers", json={"text": "the end"}).raise_for_status()
    site.api.post(f"/sessions/{session}/stop").raise_for_status()
    page.goto(f"{site.url}/#/sessions/{session}")
    region = page.get_by_role("region", name="Notes")
    region.get_by_role("button", name="Add note").click()
    region.get_by_role("textbox", name=re.compile("^Note at")).fill(NOTE)
    region.get_by_role("textbox", name=re.compile("^Note at")).press("Control+Enter")
    written = region.get_by_role("listitem").filter(has_text="Lost the bottom").first
    expect(written.get_by_role("heading", name="Lost the bottom")).to_be_visible()
    expect(written.locator("strong")).to_have_text("cold")
    # What would act is text.
    expect(written).to_contain_text("<img src=x")
    expect(written).to_contain_text("[press](javascript:alert(1))")
    expect(written.locator("img")).to_have_count(0)
    expect(page).not_to_have_title("html")
    assert notes(site, session) == [NOTE, "the end"]

    region.get_by_role("button", name=re.compile("^Edit note")).last.click()
    region.get_by_role("spinbutton", name="Time").fill("99999")
    expect(region.get_by_role("button", name="Save")).to_be_disabled()
    region.get_by_role("spinbutton", name="Time").fill("0")
    region.get_by_role("textbox", name=re.compile("^Note at")).fill("a" * 10_001)
    expect(region.get_by_text("and may have")).to_be_visible()
    region.get_by_role("textbox", name=re.compile("^Note at")).fill("surfaced")
    mark = site.api.get(f"/sessions/{session}").json()["marks"][-1]
    site.api.patch(f"/sessions/{session}/markers/{mark['id']}", json={"text": "theirs"}).raise_for_status()
    region.get_by_role("button", name="Save", exact=True).click()
    expect(region.get_by_text("was saved since you opened it")).to_be_visible()
    assert notes(site, session) == [NOTE, "theirs"]
    region.get_by_role("button", name="Save mine over it").click()
    expect(region.get_by_role("listitem").get_by_text("surfaced", exact=True)).to_be_visible()
    expect(region.get_by_role("link", name="Replay from 00:00")).to_have_count(2)
    assert "surfaced" in notes(site, session)

    region.get_by_role("button", name=re.compile("^Delete note")).first.click()
    region.get_by_role("button", name="Delete permanently").click()
    expect(region.get_by_role("link", name="Replay from 00:00")).to_have_count(1)
    assert len(notes(site, session)) == 1

    page.goto(f"{site.url}/#/sessions")
    left = notes(site, session)[0]
    page.get_by_label("Search sessions").fill("surfaced" if left == "surfaced" else "bottom")
    expect(page.get_by_role("link", name="noted", exact=True)).to_be_visible()
