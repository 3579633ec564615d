"""The last frames on the line: shown, filtered, paused, saved."""

import re
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.stack import Stack


def open_system(page: Page, stack: Stack) -> None:
    """Open System, and wait for what comes late: it moves the frames, which stand below all that."""
    page.goto(f"{stack.url}/#/system")
    control = page.get_by_role("button", name=re.compile("^Control:"))
    expect(control).to_have_accessible_name("Control: you have control")
    expect(page.get_by_role("region", name="Other programs").get_by_text("Closed.")).to_be_visible()
    expect(page.locator("summary", has_text="good check")).to_be_visible()


def test_the_last_frames_are_shown_decoded(any_page: Page, stack: Stack) -> None:
    asked: list[str] = []
    any_page.on("request", lambda request: asked.append(request.url))
    open_system(any_page, stack)
    panel = any_page.get_by_label("Frames on the serial line", exact=True)
    expect(panel.get_by_role("button", name="Show frames")).to_be_visible()
    assert not any("/api/link/frames" in url for url in asked)

    panel.get_by_role("button", name="Show frames").click()
    rows = panel.locator("tbody tr")
    expect(rows.first.locator("td").first).to_have_text(re.compile(r"0\.000"))
    panel.get_by_role("button", name="Pause").click()
    panel.get_by_label("Direction").select_option("from the board")
    expect(rows).to_have_count(100)
    expect(rows.filter(has_text="attitude, fins").first).to_be_visible()
    panel.get_by_label("Direction").select_option("to the board")
    panel.get_by_label("Kind of message").select_option("heartbeat")
    texts = rows.all_inner_texts()
    assert texts
    assert all("heartbeat" in text and "to board" in text for text in texts)
    panel.get_by_role("button", name="Bytes").click()
    expect(panel.locator("code").first).to_have_text(re.compile(r"^([0-9a-f]{2} )+00$"))

    with any_page.expect_download() as download:
        panel.get_by_role("button", name="Save").click()
    lines = Path(download.value.path()).read_text().splitlines()
    assert len(lines) == 1 + len(texts)
    assert all("\tto board\t" in line and "heartbeat" in line for line in lines[1:])
    panel.get_by_role("button", name="Hide").click()
    expect(rows).to_have_count(0)


def test_a_key_asks_what_a_column_means(page: Page, stack: Stack) -> None:
    open_system(page, stack)
    page.get_by_role("button", name="Show frames").click()
    frames = page.get_by_role("region", name="Frames, newest first")
    term = frames.get_by_role("columnheader", name="Awaits").locator("summary")
    meaning = frames.get_by_text("the reliable frame that the sender expects next")
    expect(meaning).to_be_hidden()
    term.focus()
    term.press("Enter")
    expect(meaning).to_be_visible()
