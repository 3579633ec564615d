"""Vision: a colour is picked in the picture, its mask shown, and its action chosen."""

from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.stack import Stack

COUNTS = """(image) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
    if (canvas.width === 0) return 0;
    const drawing = canvas.getContext('2d');
    drawing.drawImage(image, 0, 0);
    const { data } = drawing.getImageData(0, 0, canvas.width, canvas.height);
    let bright = 0;
    for (let at = 0; at < data.length; at += 4) bright += data[at] > 180;
    return bright / (data.length / 4);
}"""
"""The share of a picture of the mask that is drawn as what counts."""
CARD_SHARE = 0.26 * 0.36 * 3 / 4


@pytest.fixture
def card(stack: Stack, request: pytest.FixtureRequest) -> None:
    """Show a card before the page opens, so that the page has control afterwards."""
    stack.api.post("/robot/commands/card", json={"colour": request.param}).raise_for_status()


@pytest.fixture
def settings(stack: Stack) -> Iterator[dict[str, Any]]:
    """The vision settings and set points, restored afterwards."""
    before: dict[str, Any] = stack.api.get("/vision").raise_for_status().json()["settings"]
    robot = stack.api.get("/robot").json()
    points = {
        "control.set_point": robot["set_point_default"],
        "control.set_point_detected": robot["set_point_detected"],
    }
    yield before
    stack.api.post("/robot/commands/vision_settings", json=before).raise_for_status()
    stack.api.post("/robot/commands/parameters", json={"values": points}).raise_for_status()


def pick_the_middle(page: Page) -> None:
    """Pick with the cross, which begins at this place."""
    picture = page.get_by_role("button", name="Camera picture")
    picture.click()


def seen(page: Page) -> Locator:
    return page.locator("dd.word")


@pytest.mark.parametrize("card", ["blue"], indirect=True)
@pytest.mark.usefixtures("card")
def test_a_colour_is_picked_and_acted_on(settings: dict[str, Any], any_page: Page, stack: Stack) -> None:
    page = any_page
    page.goto(f"{stack.url}/#/tune/vision")
    expect(seen(page)).to_have_text("blue")
    expect(page.get_by_text("no set point of its own")).to_be_visible()

    pick_the_middle(page)
    picked = page.get_by_role("region", name="Picked colour", exact=True)
    expect(picked).to_contain_text("Not saved yet")
    expect(
        page.get_by_role("region", name="Mask of the picked colour, not saved").locator("img")
    ).to_be_visible()
    assert stack.api.get("/vision").json()["settings"] == settings
    picked.get_by_label("Name of the new colour").fill("buoy")
    picked.get_by_role("button", name="Save and detect it").click()

    mask = page.get_by_role("region", name="Mask of buoy").locator("img")
    page.wait_for_function(
        f"(image) => Math.abs(({COUNTS})(image) / {CARD_SHARE} - 1) < 0.15", arg=mask.element_handle()
    )
    expect(seen(page)).to_have_text("buoy")

    page.get_by_label("Set point while buoy is detected").fill("0.8")
    page.keyboard.press("Enter")
    expect(page.get_by_text("set point 0.80 m", exact=True)).to_be_visible()
    page.wait_for_function("async () => (await (await fetch('/api/robot')).json()).set_point === 0.8")

    # The stored settings outlast the page.
    page.reload()
    expect(page.get_by_role("radio", name="Target buoy")).to_be_checked()
    page.get_by_role("button", name="Restore robot.toml").click()
    expect(page.get_by_role("region", name="Mask of yellow")).to_be_visible()
    page.wait_for_function("async () => (await (await fetch('/api/robot')).json()).set_point === 0.5")
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("radio", name="Target buoy")).to_be_checked()


@pytest.mark.parametrize("card", ["marker 7"], indirect=True)
@pytest.mark.usefixtures("card")
def test_a_place_without_colour_is_not_picked(settings: dict[str, Any], page: Page, stack: Stack) -> None:
    page.goto(f"{stack.url}/#/tune/vision")
    page.get_by_label("ArUco markers").select_option("4x4_50")
    # Once the marker is drawn over the picture, its black and white are in the middle of it.
    expect(page.locator("svg text", has_text="marker 7")).to_be_attached()
    pick_the_middle(page)
    expect(page.get_by_text("There is no colour at this place")).to_be_visible()
    now = stack.api.get("/vision").json()["settings"]
    assert now == {**settings, "markers": "4x4_50"}
    robot = stack.api.get("/robot").json()
    assert robot["loops"][0]["set_point"] == robot["set_point_default"]
