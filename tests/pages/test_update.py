"""The update from the System page: chosen, confirmed, sent, watched to its end."""

import re
import zipfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from server import VERSION
from server.features.installation.places import InstallPlaces
from server.features.installation.plug import InstallationPlug
from server.features.installation.report import UpdateReport
from tests.browser.people import somebody
from tests.pages.dive_site import DiveSite

LOOKS = """() => performance.getEntriesByType('resource')
    .filter((one) => one.name.endsWith('/api/update'))
    .map((one) => one.startTime)"""
"""Times at which the page asked for the state of the update, ms."""


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> InstallPlaces:
    """Of a computer on which this version is installed, and 0.1.0 was before."""
    result = InstallPlaces(tmp_path_factory.mktemp("pi"))
    for folder in (result.version(VERSION), result.version("0.1.0"), result.data, result.report.parent):
        folder.mkdir(parents=True)
    result.current.symlink_to(result.version(VERSION))
    result.previous.symlink_to(result.version("0.1.0"))
    return result


@pytest.fixture(scope="module")
def installed(places: InstallPlaces) -> Iterator[DiveSite]:
    def offered() -> InstallPlaces:
        return places

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(InstallationPlug, "makers", (offered,))
        with DiveSite(places.data) as site:
            yield site


@pytest.fixture
def fresh(browser: Browser, installed: DiveSite) -> Iterator[Page]:
    """The page of an operator who has just signed in, and so needs no confirmation."""
    with somebody(browser, installed, "operator") as page:
        page.goto(f"{installed.url}/#/system")
        # Without control another panel says so, above this one, and moves it.
        control = page.get_by_role("button", name=re.compile("^Control:"))
        expect(control).to_have_accessible_name("Control: you have control")
        yield page


def panel_of(page: Page) -> Locator:
    return page.get_by_role("region", name="Update", exact=True)


def choose(page: Page, file: Path) -> None:
    with page.expect_file_chooser() as chooser:
        panel_of(page).get_by_role("button", name="Choose a release").click()
    chooser.value.set_files(file)


def test_a_release_is_sent_and_its_update_watched(fresh: Page, places: InstallPlaces, tmp_path: Path) -> None:
    release, report = tmp_path / "mucat-98.0.0.zip", UpdateReport(places.report)
    with zipfile.ZipFile(release, "w") as archive:
        archive.writestr("SHA256SUMS", "")
    panel = panel_of(fresh)
    expect(panel.get_by_text(f"Version {VERSION} is in use.")).to_be_visible()
    expect(panel.get_by_text("The way back to 0.1.0")).to_be_visible()
    choose(fresh, release)
    expect(panel.get_by_text("mucat-98.0.0.zip")).to_be_visible()
    panel.get_by_role("button", name="Cancel").click()
    expect(panel.get_by_text("mucat-98.0.0.zip")).to_have_count(0)
    assert not places.requested.exists()
    choose(fresh, release)
    panel.get_by_role("button", name="Yes, update").click()
    status = panel.get_by_role("status")
    expect(status).to_have_text("The update is about to begin.")
    assert places.requested.read_bytes() == release.read_bytes()
    # As the service that updates does it.
    report.write("running", "µ-CAT 98.0.0 is built beside it.")
    places.request.unlink()
    expect(status).to_have_text("µ-CAT 98.0.0 is built beside it.")
    # More often than the page looks without an update.
    assert min(after - before for before, after in pairwise(panel.page.evaluate(LOOKS))) < 2500
    expect(panel.get_by_role("button", name="Choose a release")).to_have_count(0)
    report.write("failed", "The signature is wrong.")
    expect(status).to_have_text("The signature is wrong.")
    expect(panel.get_by_role("button", name="Choose a release")).to_be_enabled()


def test_a_viewer_sees_the_versions_and_begins_nothing(
    browser: Browser, installed: DiveSite, places: InstallPlaces
) -> None:
    with somebody(browser, installed, "viewer") as page:
        page.goto(f"{installed.url}/#/system")
        expect(panel_of(page).get_by_text(f"Version {VERSION} is in use.")).to_be_visible()
        expect(panel_of(page).get_by_role("button", name="Choose a release")).to_be_disabled()
    assert not places.request.exists()


def test_where_nothing_is_installed_there_is_no_such_panel(page: Page, site: DiveSite) -> None:
    with page.expect_response("**/api/update"):
        page.goto(f"{site.url}/#/system")
    expect(page.get_by_role("region", name="Versions and clocks")).to_be_visible()
    expect(panel_of(page)).to_have_count(0)
