"""`python -m tests.pictures [NAME...]`: take the manual's pictures and the film, or some of them."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import Browser, Page, expect

from tests.browser.chromium import sign_in
from tests.browser.opening import launched
from tests.browser.pages import settle
from tests.browser.people import somebody
from tests.browser.site import Site
from tests.pictures.film import make_film
from tests.pictures.manual import ALL, FILM, LIT, PICTURES, SCENE, SIZES, ManualPicture
from tests.pictures.recordings import record_all
from tests.pictures.scene import write_scene
from tests.pictures.stages import RECORDED, name_numbers, open_stage
from tests.pictures.states import State, rest
from tests.stack import ROOT, Stack
from tests.waiting import SECONDS

DOCS = ROOT / "docs"
PICTURES_FOLDER = DOCS / "pictures"
QUALITY = 60
"""Of the JPEG: letters stay sharp, and a picture takes less than 120 kB."""
DOTS = {"window": 1.125}
"""Dots for each pixel of a window, where there is more than one."""
SHOWN = """() => [...document.images].every((one) => {
    const { left, top } = one.getBoundingClientRect();
    return one.complete || left > innerWidth || top > innerHeight;
})"""
"""True once all pictures in the window are loaded; others are fetched when they come into it."""
DRAWN = "() => [...document.querySelectorAll('.js-plotly-plot')].every((one) => one.querySelector('svg'))"
CHARTS_MILLISECONDS = 1500
"""With reduced motion charts are drawn anew once a second."""


def take_all(browser: Browser, pictures: tuple[ManualPicture, ...], scratch: Path, out: Path) -> None:
    """Take these pictures, stage by stage and state by state."""
    for stage, group in groupby(pictures, lambda picture: picture.stage):
        with open_stage(stage, scratch) as site:
            numbers = name_numbers(site)
            for state, same in groupby(group, lambda picture: picture.state):
                with in_state(browser, site, state):
                    for picture in same:
                        take(browser, site, picture, numbers, out / f"{picture.name}.jpg")


@contextmanager
def in_state(browser: Browser, site: Site, state: State) -> Iterator[None]:
    """Bring the robot into this state, where there is one that swims, and to rest again."""
    if not isinstance(site, Stack):
        yield
        return
    # A viewer, who leaves control to the pages that are shown.
    with somebody(browser, site, "viewer") as watcher:
        rest(site, watcher)
        state(site, watcher)
        yield
        rest(site, watcher)


def take(browser: Browser, site: Site, picture: ManualPicture, numbers: dict[str, int], file: Path) -> None:
    """Take one picture, once everything is drawn."""
    phone = "phone" in picture.size
    context = browser.new_context(
        viewport=SIZES[picture.size],
        device_scale_factor=DOTS.get(picture.size, 1.0),
        has_touch=phone,
        is_mobile=phone,
        reduced_motion="reduce",
        color_scheme="dark" if picture.theme == "dark" else "light",
    )
    sign_in(context, site.url, site.data)
    context.add_init_script(f"localStorage.setItem('mucat-theme', '{picture.theme}')")
    context.add_init_script(LIT)
    page = context.new_page()
    page.goto(f"{site.url}/#/{picture.address.format(**numbers)}")
    expect(page.get_by_role("heading", level=1).first).to_be_attached()
    draw(page)
    picture.act(page, site)
    draw(page)
    file.write_bytes(page.screenshot(type="jpeg", quality=QUALITY))
    print(f"{file}: {file.stat().st_size / 1000:.0f} kB")  # noqa: T201 - it is run from a shell
    context.close()


def draw(page: Page) -> None:
    """Wait until pictures and charts are there."""
    settle(page)
    page.wait_for_function(SHOWN)
    page.wait_for_function(DRAWN)
    page.wait_for_timeout(CHARTS_MILLISECONDS)


def take_chosen(chosen: tuple[ManualPicture, ...]) -> None:
    """Take these pictures into the manual's folder."""
    with TemporaryDirectory(prefix="mucat-") as folder:
        scratch = Path(folder)
        if any(picture.stage != "robot" for picture in chosen):
            # Where no event loop runs yet.
            record_all(scratch / RECORDED, scratch / "documents")
        with launched() as browser:
            take_all(browser, chosen, scratch, PICTURES_FOLDER)


def main(names: list[str]) -> None:
    """Make those of these names, or all."""
    unknown = {*names} - {*ALL}
    if unknown:
        sys.exit(f"There is no {', '.join(sorted(unknown))}. There are: {', '.join(ALL)}")
    expect.set_options(timeout=1000 * SECONDS)
    selected = names or ALL
    if chosen := tuple(picture for picture in PICTURES if picture.name in selected):
        take_chosen(chosen)
    if SCENE in selected:
        write_scene(PICTURES_FOLDER / f"{SCENE}.jpg", QUALITY)
    if FILM in selected:
        make_film(DOCS / f"{FILM}.mp4", PICTURES_FOLDER / f"{FILM}.jpg")


if __name__ == "__main__":
    main(sys.argv[1:])
