"""The page of a replay, as somebody uses it."""

import re

from playwright.sync_api import Locator, Page, expect


def press_depth_slider(page: Page) -> Locator:
    """Press the mouse at the start of the depth profile, once it is there; return the profile."""
    slider = page.get_by_role("slider", name="Time since the start of the session")
    # A bare line, which it takes the place of, tells no depth.
    expect(slider).to_have_attribute("aria-valuetext", re.compile(" m$"))
    box = slider.bounding_box()
    assert box is not None
    page.mouse.move(box["x"], box["y"] + box["height"] / 2)
    page.mouse.down()
    return slider
