"""The list of ten thousand sessions: how soon it is there, and how it scrolls."""

import asyncio
import tempfile
from contextlib import closing
from math import sin
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from playwright.sync_api import Page, sync_playwright
from sqlalchemy import insert

from robot_runtime.contract.chunks import encode
from robot_runtime.contract.topics import THUMBNAIL
from server.platform.models import Chunk, SessionRow, SessionTag, SummaryRow
from server.platform.schema import prepare
from server.platform.settings import DataFolder, make_folders
from server.platform.store import Store
from server.recording.schemas import CURVE_POINTS, SessionSummary
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.pages.dive_site import DiveSite
from tests.server.blocks import thumbnail_block

_SESSIONS = 10_000
_OPENED = 5
"""Openings of the list, of which the median counts."""
_SIZE = {"width": 1440, "height": 900}
_START = 1.8e9
_EVERY = 3600.0
"""s between the starts of two sessions."""
_CONTROLLERS = ("Bang-bang", "PID", "Predictive", "Model-based")
_CARDS = ("yellow", "red", "green", "blue")

# Runs in the page: how long from the change of the address until the list's first rows stand there.
_OPEN = """() => new Promise((resolve) => {
  const began = performance.now();
  const there = () => document.querySelector('[data-place] .name a') !== null;
  const look = () => there() ? resolve(performance.now() - began) : requestAnimationFrame(look);
  location.hash = '#/sessions';
  look();
})"""
# Scrolls a screen in every frame, and tells the longest time between two frames.
_SCROLL = """() => new Promise((resolve) => {
  const view = document.querySelector('main');
  let [frames, last, longest] = [0, performance.now(), 0];
  const step = (now) => {
    longest = Math.max(longest, now - last);
    [frames, last] = [frames + 1, now];
    view.scrollTop += 700;
    if (frames < 120) requestAnimationFrame(step); else resolve(longest);
  };
  requestAnimationFrame((now) => { last = now; requestAnimationFrame(step); });
})"""


def measure() -> dict[str, float]:
    """Measure ms until the list stands there, and ms of the longest frame while it is scrolled."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        fill(data, _SESSIONS)
        with DiveSite(data) as site, sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
            page = browser.new_page(viewport=_SIZE)  # type: ignore[arg-type]
            sign_in(page.context, site.url, data)
            opened = sorted(_open(page, site) for _ in range(_OPENED))
            longest = float(page.evaluate(_SCROLL))
            browser.close()
    return {"list.open_ms": opened[len(opened) // 2], "list.frame_ms_max": longest}


def _open(page: Page, site: DiveSite) -> float:
    page.goto(site.first)
    page.get_by_role("link", name="Sessions").wait_for()
    return float(page.evaluate(_OPEN))


def fill(data: Path, sessions: int) -> None:
    """Fill a new data folder with so many sessions, each with summary and picture."""
    folder = DataFolder(data)
    make_folders(folder)
    prepare(folder)
    with closing(Store(folder.database_location)) as store:
        numbers = range(1, sessions + 1)
        for table, rows in (
            (SessionRow, [_session(number) for number in numbers]),
            (SummaryRow, [_summary(number) for number in numbers]),
            (SessionTag, [{"session_id": number, "tag": "pool"} for number in numbers if number % 5 == 0]),
            (Chunk, [_picture(number) for number in numbers]),
        ):
            statement = insert(table)
            asyncio.run(store.execute(statement, rows))


def _session(number: int) -> dict[str, Any]:
    scenario = f"Steps {number % 7}" if number % 3 == 0 else ""
    started = _START + number * _EVERY
    row = SessionRow(
        id=number,
        name=f"{_depth(number):.1f} m, {_CONTROLLERS[number % 4]}, {_CARDS[number % 4]} card",
        note="",
        state="complete",
        robot="mucat",
        version="1",
        definitions="00000000",
        started=started,
        started_steady=100.0,
        ended=started + 152,
        duration=60.0 + number % 300,
        samples=90_000,
        bytes=2_000_000,
        configuration="",
        robot_state="null",
        topics="{}",
        origin="simulated" if scenario else "arming",
        scenario_name=scenario,
    )
    return row.model_dump()


def _depth(number: int) -> float:
    return 0.4 + number % 13 / 8


def _summary(number: int) -> dict[str, Any]:
    curve = [
        _depth(number) * min(1.0, part / 12) * (0.9 + 0.1 * sin(part * (1 + number % 5) / 4))
        for part in range(CURVE_POINTS)
    ]
    summary = SessionSummary(
        depth=_depth(number),
        armed=60.0,
        controllers=[_CONTROLLERS[number % 4]],
        modes=["automatic"],
        cards=[_CARDS[number % 4]],
        mission="",
        alarms=2 if number % 11 == 0 else 0,
        curve=[round(depth, 2) for depth in curve],
        face=1.0,
        damaged=False,
    )
    return {"session_id": number, "document": summary.model_dump_json()}


def _picture(number: int) -> dict[str, Any]:
    picture = np.full((120, 160, 3), (140, 90, 20), np.uint8)
    cv2.circle(picture, (80, 60), 30, (40, 200 - number % 100, 230), -1)
    block = thumbnail_block(0, 101.0, cv2.imencode(".jpg", picture)[1].tobytes())
    encoding, data, first_time, last_time = encode(THUMBNAIL, [block.payload], 1)
    return {
        "session_id": number,
        "topic": THUMBNAIL.name,
        "number": 0,
        "first_time": first_time,
        "last_time": last_time,
        "first": 0,
        "count": 1,
        "encoding": encoding,
        "data": data,
        "run": "",
    }
