"""Foxglove Studio itself, from which Lichtblick comes, at the robot's door with a shipped layout."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from server.features.doors.config import DoorsConfig
from tests.browser.opening import DESKTOP
from tests.browser.studio import serve_studio, studio_address
from tests.pages.dive_site import DiveSite
from tests.waiting import wait_for

LOADING = 120_000
"""ms; the program has 60 MB."""
SET_POINT = (110, 150, 246)
"""About the colour of the second line of a chart: blue, green, red."""


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[DiveSite]:
    with DiveSite(tmp_path / "data", DoorsConfig(foxglove=True)) as robot:
        yield robot


def has_line(page: Page) -> bool:
    """Return True where the chart of the depth shows the line of the set point over a tenth of its width."""
    # Of all charts and views that of the depth is the widest.
    boxes = [canvas.bounding_box() for canvas in page.locator("canvas").all()]
    widest = max((box for box in boxes if box is not None), key=lambda box: box["width"], default=None)
    if widest is None:
        return False
    picture = cv2.imdecode(np.frombuffer(page.screenshot(clip=widest), np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    near = np.abs(picture.astype(int) - SET_POINT).max(axis=2) < 40
    return bool(near.any(axis=0).sum() > picture.shape[1] / 10)


def test_a_shipped_layout_shows_charts_log_and_health(
    browser: Browser, robot: DiveSite, tmp_path: Path
) -> None:
    (tmp_path / "studio").mkdir()
    context = browser.new_context(viewport=DESKTOP)
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    with serve_studio(tmp_path / "studio") as program:
        page.goto(studio_address(program, robot, "lichtblick"), timeout=LOADING)
        expect(page.get_by_text("The board answers.")).to_be_visible(timeout=LOADING)
        expect(page.get_by_text("all well").first).to_be_visible(timeout=LOADING)
        expect(page.get_by_text("Unknown panel type")).to_have_count(0)
        wait_for(lambda: has_line(page), "a line in the chart of the depth")
        expect(page.get_by_role("tab", name="Problems")).to_have_text("Problems")
        context.close()
    assert complaints == []
