"""The film of the whole simulated robot: what it costs, its pictures a second and bytes; exports and seeks.

The jitter of the control loop and the processor time of each process are measured of a robot that records
without a film and of one that records with it, one after the other.
"""

import random
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import quantiles

import cv2
import numpy as np
from playwright.sync_api import Page, sync_playwright

from bench import jitter
from bench.compare import CONFIG, serve_recordings
from bench.hour import STARTED_STEADY, record_hour
from bench.real_robot import pids
from robot_runtime.contract.topics import FILM
from robot_runtime.transport.blocks import Block, row
from robot_runtime.vision.film import open_coder
from server.features.bench.process_figures import core_percent
from server.features.exports.formats import check
from server.features.exports.schemas import ExportOptions, Overlay
from server.features.exports.selection import ExportSelection
from server.features.film.config import FilmConfig
from server.library.content import Recording
from server.platform.settings import DataFolder
from server.platform.store import Reader
from server.recording.session import find_row
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.film import RATE, READ_NUMBER, draw_number
from tests.stack import ROOT, Stack

_SETTLE = 8.0
"""s: the first picture waits for the scene."""
_SECONDS = 30.0
_LENGTH = 600.0
"""s of the film that is exported and sought."""
_MINUTE = round(60 * RATE)
"""Pictures."""
_SEEKS = 100
_GIVEN_UP_MS = 10_000
"""Time limit of one seek."""


def measure() -> dict[str, float]:
    """Measure half a minute without a film and half a minute with one, and a film of ten minutes."""
    filming = _record("film_off", FilmConfig(record=False)) | _record("film_on", FilmConfig(record=True))
    return filming | _play()


def _record(name: str, config: FilmConfig) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        text = (ROOT / "robot.toml").read_text()
        (data / "robot.toml").write_text(
            text.replace("record = false", f"record = {str(config.record).lower()}")
        )
        with Stack(data, "--config", str(data / "robot.toml")) as stack:
            session = stack.api.post("/sessions", json={"name": "bench"}).raise_for_status().json()["id"]
            stack.arm()
            time.sleep(_SETTLE)
            processes = {part: stack.part(part) for part in ("runtime", "vision", "scene")}
            began = time.monotonic()
            cpu = core_percent(pids(processes | {"server": stack.server}), _SECONDS)
            stack.api.post("/robot/stop").raise_for_status()
            stack.api.post(f"/sessions/{session}/stop").raise_for_status()
        end = began + _SECONDS
        figures = {f"film.cpu.{part}_percent.{name}": value for part, value in cpu.items()}
        figures |= jitter.figures(data, session, {name: (began, end)})
        return figures | (_sizes(data, session, began, end) if config.record else {})


def _export_speeds(data: Path) -> dict[str, float]:
    """Return the film's length over the time of its export, as it is and with the flight view's lines."""
    store = Reader(DataFolder(data).database)
    speeds = dict[str, float]()
    kinds: tuple[tuple[Overlay, str], ...] = (
        ("none", "film.export_speed"),
        ("lines", "film.export_speed_lines"),
    )
    for overlay, name in kinds:
        options = ExportOptions(format="mp4", overlay=overlay)
        source = ExportSelection(store, find_row(store, 1), options)
        with tempfile.TemporaryFile() as file:
            began = time.monotonic()
            check(options).write_unpurged(store, source, file)
            speeds[name] = _LENGTH / (time.monotonic() - began)
    store.close()
    return speeds


def _films() -> Callable[[float], Iterator[Block]]:
    """Return the blocks of a film that are due by a time, s since its start.

    A minute of numbered pictures over moving ground, again and again: it begins with a key picture.
    """
    size = (640, 480)
    ground = cv2.resize(
        np.random.default_rng(1).integers(60, 180, (60, 80, 3), np.uint8), size, interpolation=cv2.INTER_CUBIC
    )
    coder = open_coder(RATE, "medium", size)
    minute = list[bytes]()
    for number in range(_MINUTE):
        picture = np.roll(ground, (2 * number, 3 * number), (0, 1))
        numbered = cv2.resize(draw_number(number), size, interpolation=cv2.INTER_NEAREST)
        shown = np.where(numbered == 128, picture, numbered).astype(np.uint8)
        minute.append(coder.code(number / RATE, shown))
    following = 0

    def due(end: float) -> Iterator[Block]:
        nonlocal following
        while (time := following / RATE) < end:
            yield Block.of(FILM, 1, following, row(STARTED_STEADY + time, minute[following % _MINUTE]))
            following += 1

    return due


def _play() -> dict[str, float]:
    """Measure a film of ten minutes: its exports, and seeks on its session's page."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        record_hour(data, _LENGTH, more=_films())
        speeds = _export_speeds(data)
        (data / "robot.toml").write_text(CONFIG)
        with serve_recordings(data) as api, sync_playwright() as playwright:
            url = str(api.base_url).rstrip("/")
            browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            sign_in(page.context, url, data)
            page.goto(f"{url}/#/sessions/1")
            delays = _seek(page)
            browser.close()
    percentiles = quantiles(delays, n=100)
    return speeds | {"film.seek_ms_p50": percentiles[49], "film.seek_ms_p95": percentiles[94]}


def _seek(page: Page) -> list[float]:
    """Return ms from each seek to a random moment until the film shows that moment's picture."""
    chance = random.Random(1)
    film = page.get_by_label("Film of the camera")
    film.wait_for()
    delays = []
    for _ in range(_SEEKS):
        number = chance.randrange(round(_LENGTH * RATE))
        delays.append(
            film.evaluate(
                f"""(video, [at, number]) => new Promise((resolve, reject) => {{
                    const began = performance.now();
                    const look = () => {{
                        const passed = performance.now() - began;
                        const seen = ({READ_NUMBER})(video);
                        if (seen === number) resolve(passed);
                        else if (passed > {_GIVEN_UP_MS}) reject(`${{seen}} at ${{at}} s, not ${{number}}`);
                        else requestAnimationFrame(look);
                    }};
                    video.currentTime = at;
                    look();
                }})""",
                [(number + 0.5) / RATE, number % _MINUTE],
            )
        )
    return delays


def _sizes(data: Path, session: int, start: float, end: float) -> dict[str, float]:
    store = Reader(DataFolder(data).database)
    sizes = [len(picture) for _, picture in Recording.open(store, session).film(start, end)]
    store.close()
    return {
        "film.picture_hz": len(sizes) / _SECONDS,
        "film.mb_a_minute": sum(sizes) / 1e6 / _SECONDS * 60,
    }
