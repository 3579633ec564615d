"""Replay on the page of the robot: the depth at a moment, its label, and no commands."""

import re

from playwright.sync_api import Page, expect

from robot_runtime.contract.packets import Depth
from robot_runtime.transport.blocks import read_blocks, read_rows
from tests.browser.driving import hold_to_arm, wait_for_depth
from tests.stack import Stack


def record_a_dive(page: Page, stack: Stack) -> tuple[int, float, float]:
    """Record a dive to 0.5 m. Return the session, the time of a bookmark (s), and the depth there (m)."""
    session = stack.api.post("/sessions", json={"name": "to be replayed"}).json()["id"]
    hold_to_arm(page)
    wait_for_depth(page, 0.2, 0.6)
    mark = stack.api.post(f"/sessions/{session}/markers", json={"text": "on the way down"}).json()
    wait_for_depth(page, 0.45, 0.55)
    stack.api.post("/robot/stop").raise_for_status()
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    exact = stack.api.get(f"/sessions/{session}/blocks", params=at(mark["time"])).content
    return session, mark["time"], newest_depth(exact)


def at(time: float) -> dict[str, float]:
    return {"start": time, "end": time, "history": 0}


def newest_depth(data: bytes) -> float:
    (block,) = (block for block in read_blocks(data) if block.topic.name == "depth")
    _, newest = read_rows(block)[-1]
    assert isinstance(newest, Depth)
    return newest.depth


def test_a_moment_is_shown_as_it_was(page: Page, stack: Stack) -> None:
    session, marked, there = record_a_dive(page, stack)
    commands: list[str] = []
    page.on("request", lambda request: commands.append(request.url) if "/api/robot/" in request.url else None)
    page.goto(f"{stack.url}/#/replay/{session}")

    label = page.get_by_role("heading", name=re.compile("of to be replayed"))
    expect(label).to_be_visible()
    expect(page.get_by_text("Replay", exact=True)).to_be_visible()
    expect(page.get_by_role("button", name="Hold to arm")).to_have_count(0)
    expect(page.get_by_role("button", name="Apply")).to_have_count(0)
    expect(page.get_by_label("default")).to_be_disabled()
    expect(page.get_by_role("button", name="no card")).to_have_count(0)
    expect(page.get_by_text("no card", exact=True)).to_be_visible()
    expect(page.get_by_text("Robot now")).to_be_visible()

    # At the beginning the robot was disarmed; at the marker it dived.
    expect(page.get_by_text("Disarmed", exact=True).first).to_be_visible()
    page.get_by_role("button", name="Next bookmark").click()
    wait_for_depth(page, there - 0.0051, there + 0.0051)
    expect(page.get_by_text("The fins may move")).to_have_count(0)
    expect(page.get_by_text(re.compile("^ARMED"))).to_be_visible()
    expect(page).to_have_url(
        re.compile(rf"#/replay/{session}\?.*\bat={re.escape(f'{round(marked, 1):g}')}(&|$)")
    )
    events = page.get_by_role("region", name="Events")
    expect(events.get_by_text("Armed.")).to_be_visible()
    expect(events.get_by_text("Stopped by the operator.")).to_have_count(0)

    page.keyboard.press("Space")
    wait_for_depth(page, 0.45, 0.55)
    page.keyboard.press("Shift+ArrowRight")
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
    expect(events.get_by_text("Stopped by the operator.")).to_be_visible()

    page.keyboard.press("Shift+ArrowLeft")
    page.get_by_role("button", name="Mark", exact=True).click()
    page.get_by_label(re.compile("^Note at 00:00")).fill("the beginning")
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Bookmark the beginning")).to_be_attached()
    marks = stack.api.get(f"/sessions/{session}/timeline").json()["markers"]
    assert [mark["text"] for mark in marks] == ["the beginning", "on the way down"]
    assert commands == []

    # The robot itself can be stopped from here, and is.
    stack.arm()
    expect(page.get_by_text("ARMED", exact=True)).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.locator(".now")).to_contain_text("disarmed")
    assert all(command.endswith("/robot/stop") for command in commands)
    # The page still shows the recording, and not what the robot did meanwhile.
    page.get_by_role("button", name="Next bookmark").click()
    wait_for_depth(page, there - 0.0051, there + 0.0051)
