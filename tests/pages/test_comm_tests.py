"""The communication test from the page: the thesis's example run, watched, compared and exported."""

import csv
import json
import re
from itertools import product
from pathlib import Path
from typing import NamedTuple

import pytest
from playwright.sync_api import Page, expect

from server.features.comm_tests.reference import read_table
from tests.browser.code import draft_of, write_code
from tests.browser.site import Site

Place = tuple[int, float, float]


class Grid(NamedTuple):
    """Bauds and delays that a test varies."""

    bauds: tuple[int, ...]
    arduino_delays: tuple[float, ...]
    pi_delays: tuple[float, ...]

    @property
    def places(self) -> list[Place]:
        return list(product(*self))


THESIS = Grid((1200, 2400, 4800, 9600, 115200), (0.0, 0.1, 0.5, 0.75, 1.0), (0.0, 0.5, 1.0))
SMALL = Grid((1200, 9600), (0.0, 0.5), (0.0,))
EXPLAINED = (1200, 0.5, 0.0)
"""A cell in which something is lost."""


def open_comm_tests(page: Page) -> None:
    page.get_by_role("link", name="Comm tests", exact=True).click()
    expect(page.get_by_role("button", name="Start the test")).to_be_enabled()


def rows_of(page: Page, region: str) -> list[list[str]]:
    """Return the texts of the table in the panel `region`, without units."""
    rows: list[list[str]] = page.get_by_role("region", name=region, exact=True).evaluate(
        """(panel) => {
            const bare = (text) => text.trim().replace(/\\s*s$/, '').replace('\u2212', '-');
            const rows = [...panel.querySelectorAll('tbody tr')];
            return rows.map((row) => [...row.cells].map((cell) => bare(cell.textContent)));
        }"""
    )
    return rows


def place_of(row: list[str]) -> Place:
    return int(row[0]), float(row[1]), float(row[2])


def test_a_run_of_the_thesis_s_example_with_fewer_cells(page: Page, tmp_path: Path) -> None:
    open_comm_tests(page)
    expect(page.get_by_role("radio", name=re.compile("Figure 10"))).to_be_checked()
    expect(page.get_by_text("75 cells", exact=False)).to_be_visible()
    make_smaller(page, SMALL)
    page.get_by_role("button", name="Start the test").click()

    many = len(SMALL.places)
    bar = page.get_by_role("progressbar", name="Cells done")
    expect(bar).to_have_attribute("aria-valuemax", str(many))
    check_run(page, tmp_path, SMALL)


def test_the_shipped_run_of_the_thesis_s_example(page: Page, site: Site, tmp_path: Path) -> None:
    """The sample that `tests/server/features/comm_tests/test_thesis_example.py` runs again, cell by cell."""
    runs = site.api.get("/comm-tests/runs").json()
    (sample,) = (run["id"] for run in runs if run["sample"] == "grid-thesis")
    page.goto(f"{site.url}/#/comm-tests/runs/{sample}")
    check_run(page, tmp_path, THESIS)


def check_run(page: Page, tmp_path: Path, grid: Grid) -> None:
    """The page of a run, its files, and the run beside the thesis's table."""
    many = len(grid.places)
    figure = page.get_by_role("img", name=re.compile("^Rates of all cells"))
    expect(figure).to_be_visible()
    expect(page.get_by_text("complete", exact=True)).to_be_visible()
    expect(figure.locator(".point")).to_have_count(many)
    shown = {place_of(row): (row[3], row[4]) for row in rows_of(page, "All cells")}
    assert set(shown) == set(grid.places)

    check_explanation(page, grid.places.index(EXPLAINED), shown[EXPLAINED][1])
    check_csv(page, tmp_path, shown)
    check_json(page, tmp_path, grid)
    check_comparison(page, {position: rate for position, (rate, _) in shown.items()})


def make_smaller(page: Page, grid: Grid) -> None:
    """The same test with fewer cells."""
    page.get_by_role("button", name="Edit", exact=True).click()
    for label, values in zip(("Baud rates", "Arduino delays", "Pi delays"), grid, strict=True):
        page.get_by_label(re.compile(f"^{label}")).fill(", ".join(f"{value:g}" for value in values))


def check_explanation(page: Page, index: int, causes: str) -> None:
    """A click on a cell of the figure shows the causes."""
    cell = page.locator(".point path").nth(index)
    box = cell.bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    text = page.get_by_role("status").filter(has_text="1200 baud, Arduino 0.5 s, Pi 0 s")
    expect(text).to_be_visible()
    for cause in causes.split(", "):
        expect(text).to_contain_text(cause, ignore_case=True)


def check_csv(page: Page, tmp_path: Path, shown: dict[Place, tuple[str, str]]) -> None:
    """The file has the cells that the page shows."""
    with page.expect_download() as download:
        page.get_by_role("link", name="Export CSV").click()
    path = tmp_path / "run.csv"
    download.value.save_as(path)
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    assert len(rows) == len(shown)
    for row in rows:
        position = int(row["baud"]), float(row["arduino_delay"]), float(row["pi_delay"])
        rate, causes = shown[position]
        assert f"{float(row['rate']):.2f}" == rate, position
        assert (row["causes"] or "none") == causes, position


def check_json(page: Page, tmp_path: Path, grid: Grid) -> None:
    """The file has the test, and the place of the run."""
    with page.expect_download() as download:
        page.get_by_role("link", name="Export JSON").click()
    path = tmp_path / "run.json"
    download.value.save_as(path)
    run = json.loads(path.read_text(encoding="utf-8"))
    assert run["document"]["baud_rate"] == list(grid.bauds)
    assert (run["state"], run["place"], len(run["cells"])) == ("complete", "emulated", len(grid.places))
    assert run["firmware"]
    assert run["tools"]


def check_comparison(page: Page, shown: dict[Place, str]) -> None:
    """The table shows the same rates beside Table 6, and the differences."""
    page.get_by_role("link", name="Compare with Table 6").click()
    expect(page.get_by_role("heading", name="Compare runs")).to_be_visible()
    expect(page.locator(".point")).to_have_count(75 + 2 * len(shown))
    thesis = read_table("table6")
    rows = rows_of(page, "All cells")
    assert len(rows) == 75
    for row in rows:
        position = place_of(row)
        assert row[3] == f"{thesis[position]:.2f}", position
        if position not in shown:
            assert row[4] == "–", position
            continue
        assert row[4] == shown[position], position
        difference = float(shown[position]) - thesis[position]
        assert float(row[5].replace("±", "")) == pytest.approx(difference, abs=1e-9), position


def test_errors_of_a_document_are_shown_field_by_field(page: Page) -> None:
    open_comm_tests(page)
    page.get_by_role("button", name="Edit", exact=True).click()
    page.get_by_label("Baud rates, bit/s").fill("9600, 300000")
    expect(page.get_by_role("textbox", name="Baud rates, bit/s")).to_have_attribute("aria-invalid", "true")
    expect(page.get_by_text("Entry 2 is")).to_be_visible()
    expect(page.get_by_role("button", name="Start the test")).to_be_disabled()
    page.get_by_label("Baud rates, bit/s").fill("9600, 250000")
    expect(page.get_by_role("button", name="Start the test")).to_be_enabled()
    page.get_by_role("button", name="JSON").click()
    document = page.get_by_role("textbox", name="The document as JSON")
    expect(document).to_be_visible()
    assert json.loads(draft_of(page, "mucat-comm-test"))[0]["baud_rate"] == [9600, 250000]
    write_code(document, "[")
    expect(page.get_by_text("not JSON").first).to_be_visible()
    expect(page.get_by_role("button", name="Start the test")).to_be_disabled()


def test_a_cancelled_run_stays_stored(page: Page) -> None:
    fetched: list[str] = []
    page.on("request", lambda request: fetched.append(request.url))
    open_comm_tests(page)
    page.get_by_role("button", name="Start the test").click()
    done = page.get_by_role("button", name=re.compile("^1200 baud, .*: rate "))
    expect(done.first).to_be_visible()
    page.reload()
    expect(done.first).to_be_visible()
    assert not any("plotly-basic" in url for url in fetched)
    page.get_by_role("button", name="Cancel…").click()
    page.get_by_role("button", name="Cancel the test").click()
    expect(page.get_by_text("cancelled", exact=True)).to_be_visible()
    expect(page.get_by_role("link", name="Export CSV")).to_be_visible()
    expect(page.locator(".point").first).to_be_visible()
    assert any("plotly-basic" in url for url in fetched)
    page.get_by_role("link", name="All comm tests").click()
    expect(page.get_by_role("row").filter(has_text="cancelled").first).to_contain_text("/ 75")


def test_a_newcomer_sees_the_samples_beside_the_thesis(any_page: Page) -> None:
    any_page.get_by_role("link", name="Comm tests", exact=True).click()
    any_page.get_by_role("link", name="Compare with the thesis").click()
    compared = any_page.get_by_role("region", name="Compared runs")
    expect(compared.get_by_role("row").filter(has_text="own link")).to_contain_text("1.00")
    expect(any_page.locator(".point").first).to_be_visible()
    wider = "document.querySelector('main').scrollWidth - document.querySelector('main').clientWidth"
    assert any_page.evaluate(wider) == 0


def test_the_page_keeps_to_its_content_policy(page: Page, site: Site) -> None:
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    page.goto(f"{site.url}/#/comm-tests/compare/table5/table6")
    expect(page.locator(".point").first).to_be_visible()
    page.locator(".point path").first.hover(force=True)
    expect(page.locator(".hoverlayer .hovertext")).to_be_visible()
    assert complaints == []
