"""The form of a session's page that makes files."""

import zipfile

import pytest
from mcap.reader import make_reader
from playwright.sync_api import Page, Route, ViewportSize, expect

from tests.browser.opening import DESKTOP, PHONE
from tests.browser.pages import SESSIONS, fill
from tests.browser.site import Site


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_a_person_chooses_the_compression_of_mcap_alone(page: Page, site: Site, size: ViewportSize) -> None:
    fill(site)
    numbers = {session["name"]: session["id"] for session in site.api.get("/sessions").json()}
    page.set_viewport_size(size)
    page.goto(f"{site.url}/#/sessions/{numbers[SESSIONS[0]]}/data")
    form = page.get_by_role("region", name="Export")
    choice = form.get_by_role("group", name="Compression")
    expect(form.get_by_role("radio", name="MCAP")).to_be_visible()
    expect(choice).to_be_hidden()
    form.get_by_role("radio", name="MCAP").check()
    expect(choice.get_by_role("button", name="None")).to_have_attribute("aria-pressed", "true")
    choice.get_by_role("button", name="Zstandard").click()
    form.get_by_role("button", name="Create file").click()
    with page.expect_download() as awaited:
        form.get_by_role("link", name="Download").click()
    with awaited.value.path().open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}
    form.get_by_role("button", name="Delete").click()
    # A page that closes now may take its question with it, and the next test would find two files.
    expect(form.get_by_role("link", name="Download")).to_have_count(0)


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_a_person_says_which_spreadsheet_reads_the_table(page: Page, site: Site, size: ViewportSize) -> None:
    fill(site)
    numbers = {session["name"]: session["id"] for session in site.api.get("/sessions").json()}
    page.set_viewport_size(size)
    page.goto(f"{site.url}/#/sessions/{numbers[SESSIONS[0]]}/data")
    form = page.get_by_role("region", name="Export")
    choice = form.get_by_role("group", name="Read by")
    expect(choice.get_by_role("button", name="Programs")).to_have_attribute("aria-pressed", "true")
    choice.get_by_role("button", name="Excel 0,5").click()
    form.get_by_role("button", name="Create file").click()
    with page.expect_download() as awaited:
        form.get_by_role("link", name="Download").click()
    with zipfile.ZipFile(awaited.value.path()) as files:
        head = files.read("depth.csv").decode().splitlines()[0]
    assert head.startswith("\ufefftime [s];utc;")
    form.get_by_role("radio", name="Excel workbook").check()
    expect(choice).to_be_hidden()
    form.get_by_role("button", name="Delete").click()
    expect(form.get_by_role("link", name="Download")).to_have_count(0)


def test_a_file_is_followed_to_its_end_where_the_list_of_files_could_not_be_read(
    page: Page, site: Site
) -> None:
    fill(site)
    numbers = {session["name"]: session["id"] for session in site.api.get("/sessions").json()}
    page.goto(f"{site.url}/#/sessions/{numbers[SESSIONS[0]]}/data")
    form = page.get_by_role("region", name="Export")
    expect(form.get_by_role("button", name="Create file")).to_be_visible()
    asked: list[str] = []

    def fail_once(route: Route) -> None:
        if route.request.method == "GET" and not asked:
            asked.append(route.request.url)
            route.abort()
        else:
            route.fallback()

    page.route("**/api/exports", fail_once)
    form.get_by_role("button", name="Create file").click()
    expect(form.get_by_role("link", name="Download")).to_be_visible()
    assert asked
    form.get_by_role("button", name="Delete").click()
    expect(form.get_by_role("link", name="Download")).to_have_count(0)
