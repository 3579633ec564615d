"""Driving: the robot moves only while a control is held on a visible page."""

import csv
import io
import re
import time
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize, expect

from server.platform.settings import DataFolder
from tests.browser.chromium import ARGUMENTS, EXECUTABLE
from tests.browser.conftest import put_to_rest
from tests.browser.driving import arm_by_hand, expect_surge
from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE, SMALL_PHONE, opened_page
from tests.exports import export_session
from tests.proofs.watching import FinWatch
from tests.stack import Stack

NEUTRAL_SECONDS = 0.5
STILL = 0.25
"""s of the board's time without motion: at each end of a stroke the fins stand still for a moment, too."""
AXES = ("x", "y", "z", "roll", "pitch", "yaw")
# A browser's data of a gamepad, in place of a real one.
GAMEPAD = """
() => {
  const buttons = Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 }));
  globalThis.pad = {
    id: 'Test pad (Vendor: 0000)', index: 0, connected: true, mapping: 'standard',
    axes: [0, 0, 0, 0], buttons, get timestamp() { return performance.now(); },
  };
  navigator.getGamepads = () => [globalThis.pad];
  dispatchEvent(Object.assign(new Event('gamepadconnected'), { gamepad: globalThis.pad }));
}
"""
KEEP_SOCKETS = """
globalThis.sockets = [];
globalThis.WebSocket = class extends WebSocket {
  constructor(...options) {
    super(...options);
    globalThis.sockets.push(this);
  }
};
"""


def expect_full_speed(page: Page) -> None:
    """Wait until the navigation command forwards is full."""
    command = page.get_by_role("region", name="Navigation command")
    expect(command.locator(".value").first).to_have_text(re.compile(r"^\s*1\.00$"))


@pytest.fixture
def in_a_window(browser: Browser, stack: Stack, cookies: StorageState, _at_rest: None) -> Iterator[Page]:
    """The page in the full browser: without windows no page can be hidden by another."""
    whole = browser.browser_type.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
    with opened_page(whole, stack, cookies, DESKTOP) as page:
        yield page
    whole.close()


def test_keys_drive_only_on_a_visible_page(in_a_window: Page, stack: Stack) -> None:
    page = in_a_window
    session = stack.api.post("/sessions", json={"name": "by hand"}).raise_for_status().json()["id"]
    arm_by_hand(page)
    page.keyboard.press("9")
    page.keyboard.down("w")
    expect_surge(page, "forwards")
    page.keyboard.up("w")
    expect_surge(page, "")
    page.keyboard.down("w")
    expect_full_speed(page)
    left = look_away(page)
    expect_surge(page, "")
    # The page sends nothing more; the fins rest, and then the robot stops by itself.
    stopped = page.context.pages[0].get_by_text("FAILSAFE", exact=True)
    expect(stopped).to_be_visible()
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()

    tables = exported(stack, session)
    rows = [(datetime.fromisoformat(row["utc"]).timestamp(), row) for row in tables["navigation.csv"]]
    driven = [at for at, row in rows if float(row["x"]) > 0]
    assert max(float(row["x"]) for _, row in rows) == 1.0
    assert left - 1 < driven[-1] <= left + NEUTRAL_SECONDS
    assert any(at > left + NEUTRAL_SECONDS for at, _ in rows)
    moved = [abs(float(row["drive_0"])) for row in tables["motor.csv"]]
    assert max(moved) > 0.5


def look_away(page: Page) -> float:
    """Bring another tab to the front. Return the time of it, s since 1970."""
    # By default Playwright gives every page the focus.
    session = page.context.new_cdp_session(page)
    session.send("Emulation.setFocusEmulationEnabled", {"enabled": False})
    page.evaluate("addEventListener('blur', () => { globalThis.left = Date.now(); })")
    page.context.new_page().bring_to_front()
    return float(page.wait_for_function("() => globalThis.left").json_value()) / 1000


def exported(stack: Stack, session: int) -> dict[str, list[dict[str, str]]]:
    """Return the tables of the session's archive."""
    archive = zipfile.ZipFile(io.BytesIO(export_session(stack.api, session).content))
    return {
        name: list(csv.DictReader(io.StringIO(archive.read(name).decode())))
        for name in archive.namelist()
        if name.endswith(".csv")
    }


def test_typing_does_not_drive(page: Page) -> None:
    arm_by_hand(page)
    field = page.get_by_label("Filter by text")
    field.focus()
    page.keyboard.down("w")
    expect(field).to_have_value("w")
    field.blur()
    page.keyboard.down("r")
    vertical = page.get_by_role("region", name="Navigation command").locator(".word").nth(2)
    expect(vertical).to_have_text("up")
    expect_surge(page, "")


def test_a_thumb_drives_on_the_pad(page: Page) -> None:
    arm_by_hand(page)
    stick: Any = page.get_by_role("img", name="right stick").bounding_box()
    x, y = stick["x"] + stick["width"] / 2, stick["y"] + stick["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - stick["height"])
    expect_surge(page, "forwards")
    page.mouse.up()
    expect_surge(page, "")


@contextmanager
def resting_afterwards(stack: Stack, begin: Callable[[], object], *, power: bool = True) -> Iterator[None]:
    """Run the block while the fins flap; after it they come to rest, with power or without.

    How soon is measured in simulated time: tests/proofs/test_faults.py.
    """
    fins = FinWatch(DataFolder(stack.data).board_socket)
    try:
        begin()
        until_seen(lambda: fins.seen[-1:] and fins.seen[-1].moving)
        yield
        until_seen(lambda: at_rest(fins) and fins.seen[-1].powered == power)
    finally:
        fins.close()


def at_rest(fins: FinWatch) -> bool:
    moved = next(sample.board for sample in reversed(fins.seen) if sample.moving)
    return fins.seen[-1].board - moved > STILL


def until_seen(condition: Any) -> None:
    end = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


def test_a_lost_gamepad_a_lost_socket_and_escape_stop_driving(page: Page, stack: Stack) -> None:
    page.add_init_script(KEEP_SOCKETS)
    page.reload()
    arm_by_hand(page)
    drive = page.get_by_role("region", name="Drive")
    page.evaluate(GAMEPAD)
    expect(drive.get_by_text("Test pad")).to_be_visible()
    with resting_afterwards(stack, lambda: page.evaluate("() => { globalThis.pad.axes = [0, 0, 0, -1]; }")):
        expect_surge(page, "forwards")
        page.evaluate("() => { globalThis.pad = null; }")
    expect(drive.get_by_text("Test pad disconnected; controls released.")).to_be_visible()
    expect_surge(page, "")
    with resting_afterwards(stack, lambda: page.keyboard.down("r")):
        page.evaluate("() => { for (const one of globalThis.sockets) one.close(); }")
    page.keyboard.up("r")
    # While the page has no control, it shows no sticks and takes no keys.
    expect(page.get_by_role("img", name="left stick")).to_be_visible()
    with resting_afterwards(stack, lambda: page.keyboard.down("r"), power=False):
        page.keyboard.press("Escape")


def test_depth_and_heading_are_held_while_driving(page: Page) -> None:
    arm_by_hand(page)
    depth = page.get_by_role("button", name="Depth hold")
    page.keyboard.press("g")
    expect(depth).to_have_attribute("aria-pressed", "true")
    page.get_by_role("button", name="Heading hold").click()
    expect(page.get_by_role("button", name="Heading hold")).to_have_accessible_name(re.compile(r"\d{3}°"))
    depth.click()
    expect(depth).to_have_attribute("aria-pressed", "false")


@pytest.mark.parametrize("size", [PHONE, SMALL_PHONE, LYING_PHONE], ids=["phone", "small", "lying"])
def test_a_phone_shows_the_picture_with_the_sticks(
    browser: Browser, stack: Stack, cookies: StorageState, size: ViewportSize
) -> None:
    context = browser.new_context(viewport=size, storage_state=cookies, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto(stack.url)
    arm_by_hand(page)
    seen = [
        page.get_by_role("img", name=re.compile("^Camera")).first,
        page.get_by_role("img", name="left stick"),
        page.get_by_role("img", name="right stick"),
        page.get_by_role("button", name="STOP"),
    ]
    for element in seen:
        expect(element).to_be_in_viewport(ratio=1)
    context.close()
    put_to_rest(stack)


def test_two_thumbs_drive_on_a_phone_and_nothing_scrolls(
    browser: Browser, stack: Stack, cookies: StorageState
) -> None:
    context = browser.new_context(
        viewport={"width": PHONE["width"], "height": PHONE["height"]},
        storage_state=cookies,
        has_touch=True,
        is_mobile=True,
    )
    page = context.new_page()
    page.goto(stack.url)
    arm_by_hand(page)
    thumbs = context.new_cdp_session(page)
    region = page.get_by_role("region", name="Drive")
    region.scroll_into_view_if_needed()
    page.get_by_role("button", name="Tilt").tap()
    scrolled = page.evaluate("() => document.querySelector('main').scrollTop")
    boxes: list[Any] = [
        page.get_by_role("img", name=f"{side} stick").bounding_box() for side in ("left", "right")
    ]
    middles = [{"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2} for box in boxes]
    ends = [{"x": middle["x"], "y": middle["y"] - 60} for middle in middles]

    def touch(kind: str, *points: dict[str, float]) -> None:
        thumbs.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": list(points)})

    touch("touchStart", *middles)
    touch("touchMove", *ends)
    page.get_by_role("tab", name="Motion").evaluate("(tab) => tab.click()")
    text = page.get_by_role("region", name="Navigation command").locator(".word")
    expect(text.nth(2)).to_have_text("up")
    expect(text.nth(4)).to_have_text("nose up")
    elsewhere = {"x": 195, "y": boxes[0]["y"] - 40}
    touch("touchStart", *ends, elsewhere)
    touch("touchMove", *ends, elsewhere | {"y": elsewhere["y"] - 120})
    assert page.evaluate("() => document.querySelector('main').scrollTop") == scrolled
    touch("touchEnd")
    expect(text.nth(2)).to_have_text("")
    context.close()
    put_to_rest(stack)
