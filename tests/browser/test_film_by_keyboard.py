"""From arming to an exported film with the flight view's lines, by keyboard alone and by accessible names."""

import re
from collections.abc import Iterator

import av
import pytest
from playwright.sync_api import Page, expect

from tests.browser.by_keyboard import press_by_keyboard
from tests.browser.driving import wait_for_depth
from tests.stack import Stack

NAME = "filmed by keys"


@pytest.fixture
def _filming_as_before(stack: Stack) -> Iterator[None]:
    plan = stack.api.get("/film").raise_for_status().json()
    yield
    order = {name: plan[name] for name in ("record", "rate", "quality")}
    stack.api.put("/film", json=order).raise_for_status()


@pytest.mark.usefixtures("_filming_as_before")
def test_a_dive_is_filmed_and_exported_by_keyboard_alone(page: Page, stack: Stack) -> None:
    press_by_keyboard(page, page.get_by_role("button", name="Record", exact=True))
    sheet = page.get_by_role("dialog", name="Record a session")
    film = sheet.get_by_role("group", name="Film").get_by_role("button", name="Low")
    press_by_keyboard(page, film)
    expect(film).to_have_attribute("aria-pressed", "true")
    press_by_keyboard(page, sheet.get_by_label("Name"), "End")
    page.keyboard.type(NAME)
    press_by_keyboard(page, sheet.get_by_role("button", name="Start recording"))
    recording = page.get_by_role("button", name=re.compile("^REC"))
    expect(recording).to_be_visible()

    press_by_keyboard(page, page.get_by_role("button", name="Hold to arm"))
    press_by_keyboard(page, page.get_by_role("button", name="Press again to arm"))
    wait_for_depth(page, 0.1, 1.0)
    page.keyboard.press("Escape")
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
    press_by_keyboard(page, recording)
    press_by_keyboard(page, page.get_by_role("button", name="Stop recording"))
    expect(recording).to_be_hidden()

    page.keyboard.press("Control+k")
    page.keyboard.type(NAME)
    expect(page.get_by_role("option", name=re.compile(NAME))).to_be_visible()
    page.keyboard.press("Enter")
    press_by_keyboard(page, page.get_by_role("link", name="Data", exact=True))
    formats = page.get_by_role("group", name="Format")
    press_by_keyboard(page, formats.get_by_role("radio", checked=True), "ArrowUp")
    expect(formats.get_by_role("radio", name="Film")).to_be_checked()
    press_by_keyboard(page, page.get_by_role("button", name="Flight lines"))
    press_by_keyboard(page, page.get_by_role("button", name="Create file"))
    file = page.get_by_role("list", name="Files of this session").get_by_role("link", name="Download")
    with page.expect_download() as download:
        press_by_keyboard(page, file)

    (job,) = [job for job in stack.api.get("/exports").json() if job["session_name"] == NAME]
    assert job["wanted"]["overlay"] == "lines"
    pictures = stack.api.get(f"/sessions/{job['session']}/film").json()["pictures"]
    with av.open(download.value.path()) as exported:
        assert sum(1 for _ in exported.decode(video=0)) == pictures > 0
