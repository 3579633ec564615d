"""Tune, Vision: a picked colour is looked at before it is saved."""

from base64 import b64encode

import cv2
import numpy as np
import pytest
from playwright.sync_api import Page, WebSocketRoute, expect

from robot_runtime.contract.topics import BY_NAME
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.transport.blocks import Block, row
from robot_runtime.vision.colour_picker import PickPoint, propose
from robot_runtime.vision.patches import draw_preview
from robot_runtime.vision.picture import Picture
from tests.pages.dive_site import DiveSite

PREVIEW = "Mask of the picked colour, not saved"


def water_with_card(card_share: float) -> Picture:
    """A blue picture with a red card of this share of its height."""
    picture = np.full((240, 320, 3), (150, 90, 20), np.uint8)
    picture[round(240 * (1 - card_share)) :] = (30, 30, 210)
    return picture


def jpeg(picture: Picture) -> bytes:
    return bytes(cv2.imencode(".jpg", picture)[1])


@pytest.mark.parametrize(("card_share", "warned"), [(0.25, False), (0.9, False), (1.0, True)])
def test_the_mask_of_a_picked_colour_is_shown_before_it_is_saved(
    unopened: Page, site: DiveSite, card_share: float, warned: bool
) -> None:
    picture = water_with_card(card_share)
    sockets: list[WebSocketRoute] = []

    def hand_on(socket: WebSocketRoute) -> None:
        sockets.append(socket)
        socket.connect_to_server()

    def pick(x: float, y: float) -> dict[str, object]:
        proposal = propose(picture, PickPoint(x=x, y=y))
        colour, share = proposal.colour, proposal.share
        mask = b64encode(jpeg(draw_preview(picture, colour, VisionSettings()))).decode()
        ranges = {part: getattr(colour, part) for part in ("hue", "saturation", "value")}
        return {"colour": ranges, "share": share, "mask": mask}

    unopened.route("**/api/vision/pick", lambda route: route.fulfill(json=pick(0.5, 0.95)))
    unopened.route_web_socket("**/api/live", hand_on)
    unopened.goto(f"{site.url}/#/tune/vision")
    # The settings come after the greeting, at which the page forgets a picture of another time.
    expect(unopened.get_by_role("region", name="Mask of yellow")).to_be_visible()
    sockets[-1].send(Block.of(BY_NAME["picture"], 1, 0, row(1.0, jpeg(picture))).data)
    unopened.get_by_role("button", name="Camera picture").click()

    preview = unopened.get_by_role("region", name=PREVIEW)
    expect(preview.get_by_role("img")).to_have_js_property("naturalWidth", 320)
    expect(preview.get_by_text("covers nearly the whole picture")).to_have_count(int(warned))
    unopened.get_by_role("button", name="Discard").click()
    expect(preview).to_have_count(0)
    expect(unopened.get_by_role("region", name="Mask of yellow")).to_be_visible()
