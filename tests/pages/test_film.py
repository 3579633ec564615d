"""The film on a session's page in two browser engines: each picture that is sought is the one of its time."""

import asyncio
import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from sqlalchemy import update
from sqlmodel import col

from robot_runtime.vision.film import open_coder
from server.library.film_removal import FilmRemoval
from server.platform.models import Chunk
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from tests.browser.firefox import Firefox
from tests.browser.opening import DESKTOP, opened_page, signed_in
from tests.browser.people import make_link
from tests.film import HEIGHT, RATE, READ_NUMBER, WIDTH, code_numbers
from tests.pages.dive_site import DiveSite
from tests.server.analysis.dives import START, STARTED_STEADY, dive, record
from tests.server.blocks import film_block
from tests.stack import ROOT
from tests.waiting import wait_for

SECONDS = 30
SOUGHT = 20.3
"""s since the session's start, of which nothing is in store when it is sought."""
FILM = "document.querySelector('[aria-label=\"Film of the camera\"]')"


def number_at(time: float) -> int:
    """Return the number of the picture that is shown at a time, s since the session's start."""
    return int((time - (START - STARTED_STEADY)) * RATE + 1e-6)


def record_film(data: Path) -> None:
    settings = Settings(data=DataFolder(data), config=ROOT / "robot.toml")
    make_folders(settings.data)
    prepare(settings.data)
    pictures = code_numbers(open_coder(RATE, "medium", (WIDTH, HEIGHT)), range(round(SECONDS * RATE)), START)
    film = [film_block(number, *picture) for number, picture in enumerate(pictures)]
    with closing(Store(settings.data.database)) as store:
        for name in ("filmed", "of a later version", "removed"):
            record(store, settings, [*dive(), *film], name=name)
        later = update(Chunk).where(col(Chunk.session_id) == 2, col(Chunk.topic) == "film")
        asyncio.run(store.write(lambda connection: connection.execute(later.values(encoding="film-2"))))
        asyncio.run(FilmRemoval(store).remove(3))


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DiveSite]:
    """A server whose first session has a film of numbered pictures, and others one that cannot be shown."""
    data = tmp_path_factory.mktemp("data")
    with ThreadPoolExecutor(1) as elsewhere:  # Playwright keeps an event loop running here
        elsewhere.submit(record_film, data).result()
    with DiveSite(data) as site:
        yield site


@pytest.fixture
def page(browser: Browser, filmed: DiveSite) -> Iterator[Page]:
    with opened_page(browser, filmed, signed_in(browser, filmed), DESKTOP) as page:
        yield page


def test_the_film_plays_and_is_sought(page: Page, filmed: DiveSite) -> None:
    page.goto(f"{filmed.url}/#/sessions/1")
    film = page.get_by_label("Film of the camera")
    expect(film).to_be_visible()
    wait_for(lambda: film.evaluate("(video) => video.readyState >= 2"), "the first picture")
    film.evaluate(f"(video) => {{ video.currentTime = {SOUGHT} }}")
    wait_for(lambda: film.evaluate(READ_NUMBER) == number_at(SOUGHT), "the picture that was sought")
    film.evaluate("(video) => video.play()")
    wait_for(lambda: film.evaluate(READ_NUMBER) > number_at(SOUGHT) + 5, "the film to play")


def test_a_session_without_small_pictures_has_them_from_its_film(page: Page, filmed: DiveSite) -> None:
    page.goto(f"{filmed.url}/#/sessions/1")
    small = (
        page.get_by_role("list", name="Camera along the dive").get_by_role("listitem").locator("img").first
    )
    wait_for(lambda: small.evaluate("(one) => one.naturalWidth === 160"), "the picture of the axis")
    page.goto(f"{filmed.url}/#/sessions")
    face = page.locator(".session").filter(has_text="filmed").locator(".face img")
    wait_for(lambda: face.evaluate("(one) => one.naturalWidth === 160"), "the session's face")
    expect(page.get_by_role("region", name="Storage")).to_contain_text(re.compile(r"\d kB of film"))


def test_a_browser_without_the_codec_shows_pictures_and_says_so(page: Page, filmed: DiveSite) -> None:
    page.add_init_script("MediaSource.isTypeSupported = () => false")
    page.goto("about:blank")
    page.goto(f"{filmed.url}/#/sessions/1?at=5")
    expect(page.get_by_text("This browser cannot play the film. Export it as MP4")).to_be_visible()
    expect(page.get_by_role("region", name="Moment").locator("dl")).to_be_visible()
    expect(page.locator("video")).to_have_count(0)


@pytest.mark.parametrize(
    ("session", "sentence"),
    [
        (2, "is encoded as 'film-2', which this version cannot read. Update µ-CAT on this computer"),
        (3, "The film was removed to make room on the disk. All other samples are there."),
    ],
)
def test_a_film_that_cannot_be_shown_says_why(
    page: Page, filmed: DiveSite, session: int, sentence: str
) -> None:
    page.goto(f"{filmed.url}/#/sessions/{session}")
    expect(page.get_by_role("region", name="Film", exact=True)).to_contain_text(sentence)
    expect(page.get_by_role("slider", name="Depth over time")).to_be_visible()
    expect(page.get_by_role("region", name="Depth").locator("img")).to_have_count(0)


def test_firefox_plays_the_film_and_seeks_it(filmed: DiveSite, tmp_path: Path) -> None:
    with Firefox(tmp_path) as firefox:
        firefox.open(make_link(filmed, "viewer"))
        firefox.move_to_button("Sign in")
        firefox.click()
        firefox.wait_for("document.querySelector('.stop')")
        firefox.open("about:blank")
        firefox.open(f"{filmed.url}/#/sessions/1")
        firefox.wait_for(f"{FILM}?.readyState >= 2")
        firefox.evaluate(f"void ({FILM}.currentTime = {SOUGHT})")
        firefox.wait_for(f"!{FILM}.seeking && ({READ_NUMBER})({FILM}) === {number_at(SOUGHT)}")
        firefox.evaluate(f"void {FILM}.play()")
        firefox.wait_for(f"({READ_NUMBER})({FILM}) > {number_at(SOUGHT) + 5}")
        assert firefox.complaints == []
