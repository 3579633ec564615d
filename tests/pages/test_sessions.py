"""Sessions: record, bookmark, rename, tag, search, delete, and undo."""

import re

from playwright.sync_api import Page, expect

from tests.browser.site import Site


def test_a_session_is_recorded_and_found_again(page: Page, site: Site) -> None:
    site.api.post("/sessions", json={"name": "another"}).raise_for_status()
    # The page has to hear of both: what it hears later would empty the form.
    expect(page.get_by_role("button", name=re.compile("^REC"))).to_be_visible()
    site.api.post(f"/sessions/{newest(site)}/stop").raise_for_status()
    expect(page.get_by_role("button", name="Record", exact=True)).to_be_visible()

    page.get_by_role("link", name="Sessions").click()
    page.get_by_label("Name", exact=True).first.fill("hover")
    page.get_by_role("button", name="Start recording").click()
    expect(page.get_by_role("region", name="Recording now")).to_be_visible()

    page.get_by_role("link", name="Operate").click()
    page.keyboard.press("m")
    page.get_by_role("button", name="Add note").click()
    page.get_by_label(re.compile("^Note at")).fill("bubbles")
    page.get_by_role("button", name="Save").click()
    page.get_by_role("button", name=re.compile("^REC")).click()
    page.get_by_role("button", name="Stop recording").click()
    # While it is being stopped, it may be in two lists.
    expect(page.get_by_role("button", name="Record", exact=True)).to_be_visible()

    page.get_by_role("link", name="Sessions").click()
    page.get_by_role("link", name="hover", exact=True).click()
    expect(page.get_by_role("region", name="Notes")).to_contain_text("bubbles")
    page.get_by_role("button", name="Edit", exact=True).click()
    page.get_by_label("Name", exact=True).last.fill("hover in a current")
    page.get_by_label("Note", exact=True).last.fill("0.1 m/s from the north")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_role("heading", name="hover in a current")).to_be_visible()
    page.get_by_label("New tag").fill("pool")
    page.keyboard.press("Enter")
    expect(page.get_by_role("list", name="Tags")).to_contain_text("pool")

    page.get_by_role("link", name="All sessions").click()
    element = page.get_by_role("list", name="Recorded sessions").get_by_role("listitem")
    page.get_by_label("Search sessions").fill("north hover")
    expect(element).to_have_count(1)
    expect(element).to_contain_text("hover in a current")
    expect(page.get_by_text(re.compile("^Times in UTC"))).to_be_visible()
    page.get_by_label("Search sessions").fill("nothing is like this")
    expect(page.get_by_text("No matching sessions")).to_be_visible()
    page.get_by_role("button", name=re.compile("^Show all")).click()
    page.get_by_role("button", name="pool", exact=True).click()
    expect(element).to_have_count(1)

    page.get_by_role("button", name="Delete hover in a current").click()
    expect(page.get_by_text("Deleted “hover in a current”")).to_be_visible()
    expect(page.get_by_role("region", name="Bin")).to_contain_text("hover in a current")
    expect(page.get_by_role("link", name="hover in a current", exact=True)).to_be_hidden()
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("link", name="hover in a current", exact=True)).to_be_visible()
    expect(page.get_by_role("region", name="Bin")).to_be_hidden()


def test_several_sessions_are_tagged_kept_exported_and_deleted_and_come_back(page: Page, site: Site) -> None:
    for name in ("first of many", "second of many", "<b>third</b> of many"):
        site.api.post("/sessions", json={"name": name}).raise_for_status()
        site.api.post(f"/sessions/{newest(site)}/stop").raise_for_status()
    third = newest(site)
    page.goto(f"{site.url}/#/sessions?search=of+many&by=day")
    rows = page.get_by_role("list", name="Recorded sessions").get_by_role("listitem")
    expect(rows).to_have_count(3)
    expect(rows.first.get_by_role("heading")).to_be_visible()

    # In place, by keyboard alone: Esc would be STOP.
    page.get_by_role("button", name="Rename <b>third</b> of many").press("Enter")
    page.get_by_label("Name", exact=True).last.fill("third <i>of many</i>")
    page.keyboard.press("Enter")
    expect(page.get_by_role("link", name="third <i>of many</i>", exact=True)).to_be_visible()
    assert site.api.get(f"/sessions/{third}").json()["name"] == "third <i>of many</i>"
    page.get_by_role("link", name="third <i>of many</i>", exact=True).focus()
    page.keyboard.press("ArrowDown")
    expect(page.get_by_role("link", name="second of many", exact=True)).to_be_focused()
    page.keyboard.press("End")
    expect(page.get_by_role("link", name="first of many", exact=True)).to_be_focused()

    for name in ("first of many", "second of many"):
        page.get_by_label(f"Select {name}").check()
    bar = page.get_by_role("group", name="Selected sessions")
    expect(bar.get_by_role("link", name="Compare 2")).to_be_visible()
    bar.get_by_role("button", name="Tag…").click()
    bar.get_by_label("New tag").fill("together")
    page.keyboard.press("Enter")
    bar.get_by_role("button", name="Keep").click()
    expect(bar.get_by_role("button", name="Do not keep")).to_be_visible()
    bar.get_by_role("button", name="Export…").click()
    bar.get_by_role("button", name="Create file").click()
    expect(bar.get_by_text("2 files are being made")).to_be_visible()
    page.get_by_role("button", name="Kept", exact=True).click()
    expect(rows).to_have_count(2)
    assert all(
        (session["kept"], session["tags"]) == (True, ["together"])
        for session in site.api.get("/sessions", params={"search": "of many", "kept": True}).json()
    )
    # The page's address is the view.
    page.reload()
    expect(rows).to_have_count(2)

    for name in ("first of many", "second of many"):
        page.get_by_label(f"Select {name}").check()
    bar.get_by_role("button", name="Delete").click()
    expect(page.get_by_text("Deleted 2 sessions")).to_be_visible()
    expect(rows).to_have_count(0)
    page.get_by_role("button", name="Undo").click()
    expect(rows).to_have_count(2)


def test_a_session_shows_the_craft_that_swam(page: Page, site: Site) -> None:
    site.api.post("/sessions", json={"name": "which craft"}).raise_for_status()
    site.api.post(f"/sessions/{newest(site)}/stop").raise_for_status()
    page.goto(f"{site.url}/#/sessions/{newest(site)}/data")
    details = page.get_by_role("region", name="Details")
    expect(details.get_by_role("term").filter(has_text="Craft")).to_be_visible()
    expect(details).to_contain_text("Default craft")
    details.get_by_text("Craft: Default craft").click()
    expect(details).to_contain_text("fin_thrust_per_drag = 13.95")


def newest(site: Site) -> int:
    return int(site.api.get("/sessions").json()[0]["id"])


def test_a_note_that_somebody_else_has_changed_meanwhile_is_not_replaced_unasked(
    page: Page, site: Site
) -> None:
    site.api.post("/sessions", json={"name": "shared"}).raise_for_status()
    number = newest(site)
    site.api.post(f"/sessions/{number}/stop").raise_for_status()
    page.goto(f"{site.url}/#/sessions/{number}")

    def save_both(message: str) -> None:
        """Another program saves a note, then this page."""
        page.get_by_role("button", name="Edit", exact=True).click()
        site.api.patch(f"/sessions/{number}", json={"note": f"theirs {message}"}).raise_for_status()
        page.get_by_label("Note", exact=True).fill(f"mine {message}")
        page.get_by_role("button", name="Save", exact=True).click()
        expect(page.get_by_text("The note of “shared” was saved since you opened it.")).to_be_visible()
        assert site.api.get(f"/sessions/{number}").json()["note"] == f"theirs {message}"

    save_both("first")
    page.get_by_role("button", name="Save mine over it").click()
    expect(page.get_by_text("mine first")).to_be_visible()
    save_both("second")
    page.get_by_role("button", name="Discard mine, open theirs").click()
    expect(page.get_by_text("theirs second")).to_be_visible()
    expect(page.get_by_text("was saved since you opened it")).to_be_hidden()
