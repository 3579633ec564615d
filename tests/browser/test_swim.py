"""The main task on the real firmware: dive, detect the card, follow, return, stop, export."""

import csv
import io
import json
import re
import zipfile
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from statistics import median

from playwright.sync_api import Page, expect

from tests.browser.driving import hold_to_arm, wait_for_depth
from tests.stack import Stack


def shown_depth(page: Page) -> tuple[datetime, float]:
    """Return the shown depth, m, and the time at which it was shown, read in one moment of the page."""
    value = page.locator(".reading", has_text="Depth").locator(".value")
    milliseconds, text = value.evaluate("element => [Date.now(), element.innerText]")
    return datetime.fromtimestamp(milliseconds / 1000, UTC), float(text)


def read_zip(data: bytes) -> dict[str, list[dict[str, str]]]:
    archive = zipfile.ZipFile(io.BytesIO(data))
    return {
        name: list(csv.DictReader(io.StringIO(archive.read(name).decode())))
        for name in archive.namelist()
        if name.endswith(".csv")
    }


def test_the_thesis_experiment(page: Page, tmp_path: Path) -> None:
    page.get_by_role("button", name="Record", exact=True).click()
    page.get_by_label("Name").fill("figure 14")
    page.get_by_role("button", name="Start recording").click()
    recording = page.get_by_role("button", name=re.compile("^REC"))
    expect(recording).to_be_visible()

    hold_to_arm(page)
    wait_for_depth(page, 0.49, 0.51)
    expect(page.get_by_text("set point 0.50 m", exact=True)).to_be_visible()

    page.get_by_role("button", name="yellow").click()
    expect(page.get_by_text("set point 1.00 m", exact=True)).to_be_visible()
    wait_for_depth(page, 0.99, 1.01)
    shown = []
    for _ in range(20):
        page.wait_for_timeout(100)  # so that the values compared are spread over two seconds
        shown.append(shown_depth(page))

    page.get_by_role("button", name="no card").click()
    expect(page.get_by_text("set point 0.50 m", exact=True)).to_be_visible()
    wait_for_depth(page, 0.49, 0.51)

    expect(page.get_by_role("log").get_by_text("armed", exact=True).last).to_be_visible()

    page.get_by_role("button", name="STOP").click()
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
    wait_for_rest(page)

    recording.click()
    page.get_by_role("button", name="Stop recording").click()
    # While it is being stopped, it may be in two lists.
    expect(page.get_by_role("button", name="Record", exact=True)).to_be_visible()
    page.get_by_role("link", name="Sessions").click()
    page.get_by_role("link", name="figure 14", exact=True).click()
    page.get_by_role("link", name="Data", exact=True).click()
    page.get_by_role("button", name="Create file").click()
    with page.expect_download() as download:
        page.get_by_role("link", name="Download").click()
    path = tmp_path / "session.zip"
    download.value.save_as(path)
    check_export(path, shown)


def wait_for_rest(page: Page) -> None:
    """Wait until no fin moves by more than a degree for half a second; encoders are never quite still."""
    page.wait_for_function(
        """() => {
            const shown = [...document.querySelectorAll('.angle')].map((one) => one.textContent);
            const now = shown.map((text) => parseInt(text.replace('−', '-')));
            const moved = (angle, fin) => !(Math.abs(angle - globalThis.fins?.[fin]) <= 1);
            if (now.some(moved)) { globalThis.fins = now; globalThis.since = performance.now(); }
            return now.length === 4 && performance.now() - globalThis.since > 500;
        }""",
        timeout=5_000,
    )


def check_export(path: Path, shown: list[tuple[datetime, float]]) -> None:
    tables = read_zip(path.read_bytes())
    session = json.loads(zipfile.ZipFile(path).read("session.json"))
    assert session["name"] == "figure 14"
    assert session["state"] == "complete"

    depths = [(datetime.fromisoformat(row["utc"]), float(row["depth [m]"])) for row in tables["depth.csv"]]
    # Each shown value was recorded before, in this order; a busy computer shows some of them late.
    ages, position = [], 0
    for when, value in shown:
        same = [
            index
            for index, (at, depth) in enumerate(depths)
            if index >= position and at <= when and abs(depth - value) <= 0.0051
        ]
        assert same, (when, value)
        position = same[0]
        ages.append((when - depths[same[-1]][0]).total_seconds())
    assert median(ages) < 0.6

    set_points = [float(row["set_point [m]"]) for row in tables["control.csv"]]
    steps = [b for a, b in pairwise(set_points) if a != b]
    # A picture that comes late lets the card be forgotten for a moment.
    assert (steps[0], steps[-1], {*steps}) == (1.0, 0.5, {0.5, 1.0})
    assert {-1.0, 1.0} <= {float(row["z"]) for row in tables["navigation.csv"]} <= {-1.0, 0.0, 1.0}
    assert "armed" in {row["text"] for row in tables["debug.csv"]}
    assert [float(tables["motor.csv"][-1][f"drive_{fin}"]) for fin in range(4)] == [0.0] * 4


def test_escape_stops_from_anywhere(page: Page) -> None:
    hold_to_arm(page)
    page.get_by_role("link", name="System").click()
    page.keyboard.press("Escape")
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()


def test_a_lost_board_is_reported_and_recovers(page: Page, stack: Stack) -> None:
    expect(page.get_by_role("button", name="Hold to arm")).to_be_visible()
    board = stack.child("build/board")
    board.suspend()
    try:
        lost = page.get_by_label("Connection lost")
        expect(lost).to_be_visible()
        expect(lost).to_contain_text("The board does not answer")
    finally:
        board.resume()
    expect(lost).to_be_hidden()
    expect(page.get_by_role("button", name="Hold to arm")).to_be_visible()


def test_a_reload_keeps_the_events(page: Page) -> None:
    hold_to_arm(page)
    page.keyboard.press("Escape")
    events = page.get_by_role("region", name="Events").get_by_role("listitem")
    expect(events.filter(has_text="Stopped by the operator.").first).to_be_visible()
    expect(events.filter(has_text="Armed.").first).to_be_visible()
    # The automatic recording ends 5 s after disarming, with a notice.
    expect(events.nth(0)).to_contain_text("has ended.", timeout=10_000)
    count = events.count()
    page.reload()
    expect(events).to_have_count(count)
    expect(page.get_by_role("log").get_by_text("armed", exact=True).first).to_be_visible()
