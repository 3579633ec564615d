"""The panels of Operate are arranged by keys and mouse, and stored by name."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.arranging import add, arrange, handle
from tests.browser.site import Site


@pytest.fixture
def fresh(page: Page, site: Site) -> Iterator[Page]:
    """The page Operate; afterwards the server has no layout."""
    page.get_by_role("link", name="Operate").click()
    yield page
    for layout in site.api.get("/layouts").json():
        site.api.delete(f"/layouts/{layout['id']}").raise_for_status()


def drag(page: Page, what: Locator, to: Locator) -> None:
    source, target = what.bounding_box(), to.bounding_box()
    assert source is not None
    assert target is not None
    page.mouse.move(source["x"] + source["width"] / 2, source["y"] + 20)
    page.mouse.down()
    page.mouse.move(target["x"] + target["width"] / 2, target["y"] + target["height"] / 2, steps=4)
    page.mouse.up()


def test_panels_are_arranged_stored_and_reset(fresh: Page, site: Site) -> None:
    page = fresh
    camera = page.get_by_role("region", name="Camera")
    expect(camera).to_be_visible()
    expect(page.get_by_role("application", name=re.compile("column"))).to_have_count(0)
    bar = arrange(page)
    status = bar.get_by_role("status")

    handle(page, "Attitude").press("ArrowDown")
    expect(status).to_have_text("Attitude and Fins swapped places.")
    expect(handle(page, "Fins")).to_have_accessible_name("Fins: column 18, row 1, 7 wide, 6 high")
    handle(page, "Camera").press("Shift+ArrowLeft")
    expect(status).to_have_text("Camera: 16 wide, 11 high.")
    handle(page, "Camera").press("Shift+ArrowRight")
    handle(page, "Camera").press("Shift+ArrowRight")
    expect(handle(page, "Attitude")).to_have_accessible_name("Attitude: column 19, row 7, 6 wide, 6 high")
    expect(handle(page, "Fins")).to_have_accessible_name("Fins: column 19, row 1, 6 wide, 6 high")
    handle(page, "Camera").press("Shift+ArrowRight")
    expect(status).to_have_text("Fins cannot be smaller.")

    drag(page, handle(page, "Navigation command"), handle(page, "Events"))
    expect(status).to_have_text("Navigation command and Events swapped places.")
    handle(page, "Console").press("Delete")
    add(page, bar, "Chart")
    bar.get_by_role("button", name="Undo").click()
    expect(handle(page, "Chart")).to_have_count(0)
    add(page, bar, "Chart")
    bar.get_by_role("button", name="Save", exact=True).click()
    bar.get_by_label("Name of the layout").fill("pool day")
    page.keyboard.press("Enter")
    expect(status).to_have_text("Saved as “pool day”.")
    bar.get_by_role("button", name="Done").click()

    chart = page.get_by_role("region", name=re.compile("^Chart"))
    chart.get_by_role("button", name="Choose signals").click()
    chart.get_by_label("Search signals").fill("pressure")
    chart.get_by_role("checkbox", name=re.compile("^pressure")).check()
    chart.get_by_role("button", name="Done").click()
    chosen = page.get_by_label("Layout of the panels")
    expect(chosen.locator("option:checked")).to_have_text("pool day (changed)")

    page.reload()
    expect(page.get_by_role("region", name="Chart of pressure")).to_be_visible()
    expect(page.get_by_role("region", name="Console")).to_have_count(0)
    chosen.select_option("pool day")
    expect(page.get_by_role("region", name="Chart", exact=True)).to_be_visible()

    arrange(page).get_by_role("button", name="Reset").click()
    page.get_by_role("button", name="Done").click()
    expect(page.get_by_role("region", name="Console")).to_be_visible()
    expect(chart).to_have_count(0)
    assert [layout["name"] for layout in site.api.get("/layouts").json()] == ["pool day"]


def test_a_layout_of_another_version_is_refused(fresh: Page, tmp_path: Path) -> None:
    page = fresh
    bar = arrange(page)
    bar.get_by_role("button", name="File").click()
    with page.expect_download() as download:
        bar.get_by_role("button", name="Save to a file").click()
    layout = json.loads(download.value.path().read_text())
    file = tmp_path / "theirs.layout.json"
    before = [
        column.get_attribute("aria-label") for column in page.get_by_role("application", name="column").all()
    ]
    assert len(before) == 8

    bar.get_by_role("button", name="File").click()
    file.write_text(json.dumps(layout | {"version": 2, "panels": []}))
    bar.get_by_label("Open a layout file").set_input_files(file)
    expect(bar.get_by_role("alert")).to_have_text(
        "This layout has version 2. This program reads version 1. Nothing was changed."
    )
    after = [
        column.get_attribute("aria-label") for column in page.get_by_role("application", name="column").all()
    ]
    assert after == before

    unknown = {"id": "a", "panel": "sonar", "x": 0, "y": 0, "width": 6, "height": 6}
    file.write_text(json.dumps(layout | {"panels": [unknown]}))
    bar.get_by_label("Open a layout file").set_input_files(file)
    expect(handle(page, "Unknown panel “sonar”")).to_be_visible()
    bar.get_by_role("button", name="Done").click()
    expect(page.get_by_role("region", name="sonar")).to_contain_text("which this version does not have")


def test_what_is_read_aloud_alone_does_not_make_the_page_longer(fresh: Page) -> None:
    expect(fresh.get_by_role("region", name="Camera")).to_be_visible()
    main = fresh.get_by_role("main")
    assert main.evaluate("(main) => main.scrollHeight - main.clientHeight") == 0
