"""`python -m tests.pictures [NAME...]`: take the manual's pictures and the film, or some of them."""

import sys
from collections.abc import Callable, Iterator
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
from tests.pictures.calm import find_alarms, take_calm
from tests.pictures.film import make_film
from tests.pictures.manual import ALL, FILM, LIT, PICTURES, SCENE, SIZES, ManualPicture
from tests.pictures.scene import write_scene
from tests.pictures.stages import RECORDED, name_numbers, open_stage, record_past
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
                with in_state(browser, site, state) as find_alarms_anew:
                    for picture in same:
                        file = out / f"{picture.name}.jpg"

                        def take_one() -> list[str]:
                            take(browser, site, picture, numbers, file)  # noqa: B023 - it is called here
                            return find_alarms_anew()

                        take_calm(take_one)


@contextmanager
def in_state(browser: Browser, site: Site, state: State) -> Iterator[Callable[[], list[str]]]:
    """Bring the robot into this state, where there is one that swims, and to rest again.

    Yield a function that returns the alarms that stand, and in that case brings it into the state anew.
    """
    if not isinstance(site, Stack):
        yield list
        return
    # A viewer, who leaves control to the pages that are shown.
    with somebody(browser, site, "viewer") as watcher:

        def begin() -> None:
            rest(site, watcher)
            state(site, watcher)

        def find_alarms_anew() -> list[str]:
            if alarms := find_alarms(site):
                begin()
            return alarms

        begin()
        yield find_alarms_anew
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


def main(names: list[str]) -> None:
    """Make those of these names, or all, into the manual's folder."""
    unknown = {*names} - {*ALL}
    if unknown:
        sys.exit(f"There is no {', '.join(sorted(unknown))}. There are: {', '.join(ALL)}")
    expect.set_options(timeout=1000 * SECONDS)
    selected = names or ALL
    chosen = tuple(picture for picture in PICTURES if picture.name in selected)
    if SCENE in selected:
        write_scene(PICTURES_FOLDER / f"{SCENE}.jpg", QUALITY)
    with TemporaryDirectory(prefix="mucat-") as folder:
        scratch = Path(folder)
        if FILM in selected or any(picture.stage != "robot" for picture in chosen):
            # Where no event loop runs yet.
            record_past(scratch)
        if chosen:
            with launched() as browser:
                take_all(browser, chosen, scratch, PICTURES_FOLDER)
        if FILM in selected:
            make_film(scratch / RECORDED, DOCS / f"{FILM}.mp4", PICTURES_FOLDER / f"{FILM}.jpg")


if __name__ == "__main__":
    main(sys.argv[1:])
