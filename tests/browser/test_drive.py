"""Driving by hand: the robot moves while something is held and somebody looks, and rests otherwise."""

import csv
import io
import zipfile
from datetime import datetime
from typing import Any

from playwright.sync_api import Page, expect

from tests.browser.test_swim import hold_to_arm
from tests.stack import Stack

NEUTRAL_SECONDS = 0.5
AXES = ("x", "y", "z", "roll", "pitch", "yaw")


def arm_by_hand(page: Page) -> None:
    page.get_by_role("button", name="Manual", exact=True).click()
    hold_to_arm(page)
    expect(page.get_by_role("region", name="Drive")).to_be_visible()


def expect_surge(page: Page, words: str) -> None:
    """The navigation command says this of the way ahead."""
    command = page.get_by_role("region", name="Navigation command")
    expect(command.locator(".word").first).to_have_text(words)


def test_keys_drive_and_rest_where_nobody_looks(page: Page, stack: Stack) -> None:
    session = stack.api.post("/sessions", json={"name": "by hand"}).raise_for_status().json()["id"]
    arm_by_hand(page)
    page.keyboard.down("w")
    expect_surge(page, "forwards")
    page.keyboard.up("w")
    expect_surge(page, "")
    page.keyboard.down("w")
    expect_surge(page, "forwards")
    left = look_away(page)
    expect_surge(page, "")
    # The page says nothing more; the robot rests, and at last stops by itself.
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
    """Bring another tab to the front, which nobody drives by. Returns when that was, s since 1970."""
    # Playwright lets every page believe that it has the focus.
    session = page.context.new_cdp_session(page)
    session.send("Emulation.setFocusEmulationEnabled", {"enabled": False})
    page.evaluate("addEventListener('blur', () => { globalThis.left = Date.now(); })")
    page.context.new_page().bring_to_front()
    return float(page.wait_for_function("globalThis.left").json_value()) / 1000


def exported(stack: Stack, session: int) -> dict[str, list[dict[str, str]]]:
    """The tables of the session's archive."""
    archive = zipfile.ZipFile(
        io.BytesIO(stack.api.get(f"/sessions/{session}/csv").raise_for_status().content)
    )
    return {
        name: list(csv.DictReader(io.StringIO(archive.read(name).decode())))
        for name in archive.namelist()
        if name.endswith(".csv")
    }


def test_typing_does_not_drive(page: Page) -> None:
    arm_by_hand(page)
    field = page.get_by_label("Text that lines must hold")
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
