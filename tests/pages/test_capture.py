"""Snapshots: taken by key and button, and shown in the session's album."""

import re

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, StorageState, ViewportSize, expect

from tests.browser.axe import AXE, faults
from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE, opened_page
from tests.browser.people import somebody
from tests.pages.dive_site import DiveSite

SIZES = pytest.mark.parametrize("size", [DESKTOP, PHONE, LYING_PHONE], ids=["desktop", "phone", "lying"])


def picture() -> bytes:
    """Return a picture of 640 x 480: blue above, a yellow card below."""
    drawn = np.full((480, 640, 3), (150, 90, 20), np.uint8)
    drawn[300:420, 220:420] = (40, 200, 230)
    return bytes(cv2.imencode(".jpg", drawn)[1])


@SIZES
@pytest.mark.usefixtures("_at_rest")
def test_a_snapshot_is_taken_by_key_and_opened_in_the_album(
    browser: Browser, site: DiveSite, cookies: StorageState, size: ViewportSize
) -> None:
    with opened_page(browser, site, cookies, size) as page:
        page.get_by_role("link", name="Operate").click()
        button = page.get_by_role("region", name="Camera").get_by_role("button", name="Snapshot")
        notice = page.get_by_role("region", name="Snapshots")
        button.click()
        expect(notice.get_by_role("alert")).to_contain_text("Start a recording")
        site.api.post("/sessions", json={"name": "album"}).raise_for_status()
        site.show(picture())
        expect(page.get_by_role("button", name=re.compile("^REC"))).to_be_visible()
        page.keyboard.press("p")
        expect(notice.get_by_role("status")).to_contain_text("Snapshot kept at 00:0")
        notice.get_by_role("link", name="Show album").click()
        album = page.get_by_role("region", name="Snapshots")
        album.get_by_role("button", name="Snapshot 00:").click()
        large = album.get_by_role("img", name="The camera’s picture at")
        expect(large).to_have_js_property("naturalWidth", 640)
        expect(album.get_by_role("definition").nth(1)).to_contain_text("m")
        with page.expect_download() as download:
            album.get_by_role("link", name="Download").click()
        assert download.value.path().read_bytes() == picture()
        page.evaluate(f"{AXE.read_text()};0")
        assert faults(page) == []


@pytest.mark.usefixtures("_at_rest")
def test_a_viewer_looks_and_takes_none(browser: Browser, site: DiveSite) -> None:
    with somebody(browser, site, "viewer") as page:
        page.get_by_role("link", name="Operate").click()
        expect(
            page.get_by_role("region", name="Camera").get_by_role("button", name="Snapshot")
        ).to_be_disabled()
        page.keyboard.press("p")
        expect(page.get_by_role("region", name="Snapshots").get_by_role("alert")).to_be_visible()
