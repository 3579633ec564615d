"""A session that a lab has fetched, on its page: all of it is there, and nothing that needs a robot."""

import asyncio
import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from sqlalchemy import insert

from robot_runtime.config import ZenohConfig
from robot_runtime.vision.film import open_coder
from server.platform.models import BookmarkRow
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from tests.browser.opening import DESKTOP
from tests.browser.people import follow, make_link
from tests.film import HEIGHT, RATE, WIDTH, code_numbers
from tests.pages.threaded_site import ThreadedSite
from tests.server.analysis.dives import START, dive, record
from tests.server.blocks import film_block
from tests.server.features.lab.labs import serve_lab
from tests.server.postgres import new_archive
from tests.stack import ROOT, free_port
from tests.waiting import wait_for

FILM_SECONDS = 5


class ArchiveSite(ThreadedSite):
    """A lab with its page in a thread; its archive holds two dives with films and bookmarks."""

    def __init__(self, data: Path, archive: str) -> None:
        super().__init__(data)
        self._archive = archive

    @property
    def first(self) -> str:
        """The page of the sessions."""
        return f"{self.url}/#/sessions"

    async def _serve(self) -> None:
        folder = DataFolder(self.data)
        make_folders(folder)
        folder.lab.write_text(self._archive)
        settings = Settings(data=folder, config=ROOT / "robot.toml", lab=True)
        settings = replace(settings, zenoh=ZenohConfig(listen=[f"tls/127.0.0.1:{free_port()}"]))
        with ThreadPoolExecutor(1) as elsewhere:
            elsewhere.submit(fill, settings).result()
        async with serve_lab(settings, self._archive) as lab:
            self.port = lab.api.base_url.port or 0
            self._started.set()
            while not self._end.is_set():
                await asyncio.sleep(0.1)


def fill(settings: Settings) -> None:
    """Record the dives, where no event loop runs."""
    prepare(settings.data)
    pictures = code_numbers(
        open_coder(RATE, "medium", (WIDTH, HEIGHT)), range(round(FILM_SECONDS * RATE)), START
    )
    film = [film_block(number, *picture) for number, picture in enumerate(pictures)]
    with closing(Store(settings.data.database_location)) as store:
        for name in ("pool in the morning", "pool in the evening"):
            number = record(store, settings, [*dive(), *film], name=name)
            mark = {"session_id": number, "time": START + 5.0, "text": "It turned **here**.", "made": 1.8e9}
            asyncio.run(store.execute(insert(BookmarkRow), [mark]))


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def lab(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ArchiveSite]:
    archive = new_archive() if request.param == "postgresql" else ""
    with ArchiveSite(tmp_path_factory.mktemp("lab"), archive) as site:
        yield site


@pytest.fixture
def page(browser: Browser, lab: ArchiveSite) -> Iterator[Page]:
    with browser.new_context(viewport=DESKTOP) as context:
        page = context.new_page()
        follow(page, make_link(lab, "operator"))
        expect(page.get_by_role("heading", name="Robots")).to_be_visible()
        yield page


def test_a_session_is_whole_on_a_lab_s_page(page: Page, lab: ArchiveSite) -> None:
    page.goto(f"{lab.url}/#/sessions/1")
    film = page.get_by_label("Film of the camera")
    wait_for(lambda: film.evaluate("(video) => video.readyState >= 2"), "the film")
    expect(page.get_by_text("It turned here.").first).to_be_visible()
    expect(page.get_by_role("alert").filter(has_text=re.compile(r"\S"))).to_have_count(0)
    page.get_by_role("link", name="Exhibit").click()
    expect(page.get_by_role("heading", name="Exhibit")).to_be_attached()
    page.goto(f"{lab.url}/#/replay/1?at=6")
    expect(page.get_by_role("slider").first).to_be_visible()
    page.goto(f"{lab.url}/#/sessions/compare/1,2")
    expect(page.get_by_text("pool in the evening").first).to_be_visible()
