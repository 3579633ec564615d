"""The camera's picture and the choices beside it."""

import json
import re
from collections.abc import Iterator

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, WebSocketRoute, expect

from robot_runtime.contract.topics import BY_ID, BY_NAME
from robot_runtime.transport.blocks import HEADER, Block, row
from tests.browser.people import somebody
from tests.pages.dive_site import DiveSite
from tests.pages.flying import Flown

TAKEN = 1.0
"""Time of the picture, s."""
MARKER = {"number": 7, "corners": [0.2, 0.2, 0.4, 0.2, 0.4, 0.4, 0.2, 0.4]}


def picture() -> bytes:
    _, jpeg = cv2.imencode(".jpg", np.zeros((60, 80, 3), np.uint8))
    return Block.of(BY_NAME["picture"], 1, 0, row(TAKEN, jpeg.tobytes())).data


def with_markers(message: bytes) -> bytes:
    """Return the blocks of a message; every detection is of the picture, and found two markers."""
    changed = b""
    while message:
        topic, _, count, first, size = HEADER.unpack_from(message)
        payload, message = message[HEADER.size : HEADER.size + size], message[HEADER.size + size :]
        if topic == BY_NAME["detection"].id:
            results = {"taken": TAKEN, "markers": [MARKER, MARKER]}
            payload = json.dumps([document | results for document in json.loads(payload)]).encode()
        changed += Block.of(BY_ID[topic], count, first, payload).data
    return changed


def test_two_markers_of_one_number_are_drawn(unopened: Page, site: DiveSite) -> None:
    sockets: list[WebSocketRoute] = []

    def hand_on(socket: WebSocketRoute) -> None:
        def change(message: str | bytes) -> None:
            socket.send(with_markers(message) if isinstance(message, bytes) else message)

        sockets.append(socket)
        socket.connect_to_server().on_message(change)

    unopened.route_web_socket("**/api/live", hand_on)
    unopened.goto(f"{site.url}/#/operate")
    camera = unopened.get_by_role("region", name="Camera")
    expect(camera.get_by_text("No picture yet")).to_be_visible()
    # The state comes after the greeting, at which the page forgets a picture of another time.
    expect(camera.get_by_label("Vision rate")).to_be_visible()
    sockets[-1].send(picture())
    expect(camera.locator("svg text", has_text="marker 7")).to_have_count(2)


def test_a_picture_that_stops_is_said_with_its_reason(unopened: Page, site: DiveSite) -> None:
    flown = Flown(unopened)
    flown.camera_failure = "No picture: the camera /dev/video0 gives no picture; check its plug."
    unopened.goto(f"{site.url}/#/operate")
    camera = unopened.get_by_role("region", name="Camera")
    expect(camera.get_by_text(flown.camera_failure)).to_be_visible()
    expect(camera.get_by_text("No picture")).to_have_count(1)
    for topic in ("picture", "camera"):
        flown.show(topic)
    expect(camera.get_by_role("alert")).to_have_text(
        f"The camera’s picture has stopped. {flown.camera_failure}"
    )
    expect(camera.get_by_text(re.compile(r"picture is \d.* old"))).to_be_visible()
    # All else goes on: the depth is of now, and commands are sent.
    expect(unopened.get_by_role("region", name="Depth over time").get_by_text("old")).to_have_count(0)
    camera.get_by_label("Vision rate").select_option("8")
    expect(camera.get_by_role("alert")).to_have_count(1)
    unopened.get_by_role("button", name="STOP").click()
    expect(unopened.get_by_role("button", name="Stopped")).to_be_visible()
    flown.camera_failure = None
    flown.show("camera")
    expect(camera.get_by_role("alert")).to_have_count(0)


@pytest.fixture
def refusing(site: DiveSite) -> Iterator[str]:
    """The reason for which the robot refuses every command."""
    reason = "An experiment is running."
    site.refuse(reason)
    yield reason
    site.refuse(None)


def test_a_refused_choice_does_not_stay_in_its_field(page: Page, refusing: str) -> None:
    page.get_by_role("link", name="Operate").click()
    camera = page.get_by_role("region", name="Camera")
    for label, refused, present in (("Target colour", "red", "yellow"), ("Vision rate", "8", "4")):
        field = camera.get_by_label(label)
        field.select_option(refused)
        expect(camera.get_by_role("alert")).to_contain_text(refusing)
        expect(field).to_have_value(present)


def with_a_scene(message: str) -> str:
    """Return a text message; in that of the parts there is a scene, which a bystander sees."""
    answer = json.loads(message)
    if answer["op"] == "health":
        scene = {"name": "scene", "state": "works", "text": ""}
        answer["parts"] = [part for part in answer["parts"] if part["name"] != "scene"] + [scene]
    return json.dumps(answer)


def test_a_viewer_only_looks_at_the_scene(browser: Browser, site: DiveSite) -> None:
    def hand_on(socket: WebSocketRoute) -> None:
        def change(message: str | bytes) -> None:
            socket.send(with_a_scene(message) if isinstance(message, str) else message)

        socket.connect_to_server().on_message(change)

    with somebody(browser, site, "viewer") as page:
        views: list[str] = []
        page.on(
            "request",
            lambda request: views.append(request.url) if request.url.endswith("/scene/view") else None,
        )
        page.route_web_socket("**/api/live", hand_on)
        page.reload()
        page.get_by_role("link", name="Operate").click()
        camera = page.get_by_role("region", name="Camera")
        camera.get_by_text("bystander", exact=True).click()
        stage = camera.get_by_role("application")
        expect(stage).to_have_accessible_name("The robot in the simulated water")
        stage.hover()
        page.mouse.wheel(0, 100)
        page.mouse.down()
        page.mouse.move(0, 0)
        page.mouse.up()
        stage.press("ArrowLeft")
        # Answered after whatever was asked before.
        page.evaluate("() => fetch('/api/scene')")
        assert views == []
