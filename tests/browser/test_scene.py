"""The bystander's view: rendered only while it is shown."""

import re

from playwright.sync_api import Page, expect


def test_the_bystander_shows_the_robot_and_can_be_turned(any_page: Page) -> None:
    any_page.get_by_role("button", name="bystander").click()
    # On a phone it may stand below the fold, where nobody looks at it.
    stage = any_page.get_by_role("application")
    stage.scroll_into_view_if_needed()
    picture = any_page.get_by_alt_text("The robot in the simulated water")
    expect(picture).to_be_visible()
    any_page.wait_for_function("() => document.querySelector('.stage img').naturalWidth === 640")

    # Chromium tells nothing of the body of a request that a page has made beforehand.
    any_page.evaluate("""() => {
        const whole = window.fetch;
        window.sent = [];
        window.fetch = async (request) => {
            window.sent.push(await request.clone().text());
            return whole(request);
        };
    }""")
    with any_page.expect_response(re.compile("/api/scene/view")):
        stage.press("ArrowRight")
    assert any('"azimuth":-36' in body for body in any_page.evaluate("sent"))
    with any_page.expect_response(re.compile("/api/scene/view")) as answered:
        any_page.get_by_role("button", name="top", exact=True).click()
    assert answered.value.status == 204
    expect(any_page.get_by_role("button", name="top", exact=True)).to_have_attribute("aria-pressed", "true")

    any_page.reload()
    stage.scroll_into_view_if_needed()
    expect(picture).to_be_visible()
    any_page.get_by_role("button", name="robot", exact=True).click()
    expect(picture).to_be_hidden()
