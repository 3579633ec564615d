"""The product's default camera, a rendered scene, from a target in the water to the set point on the page."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from robot_runtime.simulation.scene.availability import missing
from robot_runtime.transport.zenoh_transport import join
from tests.browser.chromium import sign_in
from tests.browser.opening import DESKTOP
from tests.stack import Stack
from tests.waiting import wait_for

BALL = {"colour": "yellow", "position": [0.9, 0.0, 0.2], "size": 0.3}
"""In front of the floating robot; m."""
YELLOW = """(image) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
    if (canvas.width === 0) return false;
    const drawing = canvas.getContext('2d');
    drawing.drawImage(image, 0, 0);
    const { data } = drawing.getImageData(0, 0, canvas.width, canvas.height);
    let yellow = 0;
    for (let at = 0; at < data.length; at += 4) yellow += data[at] > 1.5 * data[at + 2];
    return yellow / (data.length / 4) > 0.01;
}"""
"""True where at least 1 % of a picture is yellow: water is blue."""


@pytest.fixture
def rendered(tmp_path: Path) -> Iterator[Stack]:
    """A robot as `make run` starts it, with a rendered camera."""
    with Stack(tmp_path) as stack:
        yield stack


@pytest.mark.skipif(missing() is not None, reason="the scene cannot be rendered here")
def test_a_target_in_the_water_is_found_and_changes_the_set_point(browser: Browser, rendered: Stack) -> None:
    context = browser.new_context(viewport=DESKTOP, reduced_motion="reduce")
    sign_in(context, rendered.url, rendered.data)
    page = context.new_page()
    page.goto(rendered.url)
    camera = page.get_by_role("region", name="Camera")
    detected = camera.get_by_role("definition").first
    set_point = page.get_by_role("region", name="Depth and heading").get_by_text("set point")
    expect(detected).to_have_text("nothing")
    expect(set_point).to_contain_text("0.50")
    # The state that names the camera is published a moment later than its first picture.
    wait_for(
        lambda: rendered.api.get("/robot").json()["camera"] == "rendered scene", "the camera's name", 5.0
    )

    put_targets(rendered, BALL)
    expect(detected).to_have_text("yellow")
    expect(set_point).to_contain_text("1.00")
    picture = camera.locator("img").first
    page.wait_for_function(YELLOW, arg=picture.element_handle())

    put_targets(rendered)
    expect(detected).to_have_text("nothing")
    expect(set_point).to_contain_text("0.50")
    context.close()


def put_targets(stack: Stack, *targets: dict[str, object]) -> None:
    """Replace the targets in the water by these."""
    runtime = f"unixsock-stream/{stack.data}/run/runtime.sock"
    with join("turtle", [runtime]) as messages:
        messages.query("scene/targets", {"targets": list(targets)}, 10.0)
