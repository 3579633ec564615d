"""The bystander's view: rendered only while it is shown."""

import re

from playwright.sync_api import Page, expect

from tests.stack import Stack

SCENE_MS = 60_000
"""The first picture waits for everything in the scene."""


def test_the_bystander_shows_the_robot_and_can_be_turned(any_page: Page) -> None:
    any_page.get_by_role("button", name="bystander").click()
    picture = any_page.get_by_alt_text("The robot in the simulated water")
    expect(picture).to_be_visible(timeout=SCENE_MS)
    any_page.wait_for_function("() => document.querySelector('.stage img').naturalWidth === 640")

    stage = any_page.get_by_role("application")
    with any_page.expect_request(re.compile("/api/scene/view")) as turned:
        stage.press("ArrowRight")
    assert '"azimuth":-36' in (turned.value.post_data or "")
    with any_page.expect_response(re.compile("/api/scene/view")) as answered:
        any_page.get_by_role("button", name="top", exact=True).click()
    assert answered.value.status == 204
    expect(any_page.get_by_role("button", name="top", exact=True)).to_have_attribute("aria-pressed", "true")

    any_page.reload()
    expect(picture).to_be_visible(timeout=SCENE_MS)
    any_page.get_by_role("button", name="robot", exact=True).click()
    expect(picture).to_be_hidden()


def test_an_invalid_view_is_refused(stack: Stack) -> None:
    answer = stack.api.put("/scene/view", json={"name": "top", "azimuth": 0, "elevation": 95, "distance": 1})
    assert answer.status_code == 422
    assert "elevation" in answer.json()["detail"]
