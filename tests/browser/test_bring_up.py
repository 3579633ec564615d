"""The bring-up on the page: begun on the emulated board, some of its steps, a motor, and the end."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.proofs.watching import wait
from tests.stack import Stack

UPLOAD_MS = 60_000
UPLOAD_SECONDS = 60.0


@pytest.fixture(autouse=True)
def _ended(stack: Stack) -> Iterator[None]:
    """Ends the bring-up, and waits for the robot's firmware."""
    yield
    stack.api.delete("/bring-up").raise_for_status()
    wait(lambda: stack.api.get("/bring-up").json()["phase"] == "idle", "the end", UPLOAD_SECONDS)
    stack.wait_ready()


def test_a_robot_is_brought_up_step_by_step(page: Page, stack: Stack) -> None:
    page.goto(f"{stack.url}/#/bring-up")
    page.get_by_role("button", name="Begin", exact=True).click()
    expect(page.get_by_text("0 of 16 steps done")).to_be_visible(timeout=UPLOAD_MS)
    steps = page.get_by_role("list", name="Steps of the bring-up")
    page.get_by_role("button", name="Look who answers").click()
    expect(page.get_by_role("row", name="IMU at 0x69")).to_contain_text("answers")
    expect(steps.get_by_role("link", name="Devices on the bus")).to_have_text(re.compile("✓.*done"))
    page.get_by_role("button", name="Next step").click()

    # What was skipped says so, and may be done later.
    expect(page.get_by_role("heading", name="Encoders and the kind of IMU")).to_be_focused()
    page.get_by_role("button", name="Skip this step").click()
    expect(steps.get_by_role("link", name="Encoders and the kind of IMU")).to_have_text(re.compile("skipped"))
    compare = page.get_by_role("button", name="Compare")
    page.get_by_role("spinbutton", name="Multimeter").fill("12")
    expect(compare).to_be_disabled()
    page.get_by_role("spinbutton", name="Multimeter").fill("6")
    compare.click()
    expect(page.get_by_role("table", name="Results").locator(".advice")).to_be_visible()

    # The motor turns while the button is held, and its encoder with it.
    steps.get_by_role("link", name="Motor back right").click()
    expect(page).to_have_url(re.compile("#/bring-up/motor_1"))
    angle = page.get_by_role("definition").nth(1)
    before = angle.inner_text()
    turn = page.get_by_role("button", name="Hold to turn it")
    turn.hover()
    page.mouse.down()
    expect(page.get_by_role("button", name="Turning. Let go to stop.")).to_be_visible()
    expect(angle).not_to_have_text(before)
    page.mouse.up()
    expect(turn).to_be_visible()
    page.get_by_role("combobox", name="Fin").select_option("back right")
    page.get_by_role("button", name="This one turned").click()
    expect(steps.get_by_role("link", name="Motor back right")).to_have_text(re.compile("done"))

    page.get_by_role("button", name="End", exact=True).click()
    page.get_by_role("button", name="End the bring-up").click()
    expect(page.get_by_role("button", name="Begin", exact=True)).to_be_visible(timeout=UPLOAD_MS)
    expect(page.get_by_role("link", name="Report of the last bring-up")).to_be_visible()
