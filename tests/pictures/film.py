"""A minute of the running product, as MP4, and its poster."""

import time
from base64 import b64decode
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Locator, Page, ViewportSize, expect

from tests.browser.chromium import sign_in
from tests.browser.driving import hold_to_arm, wait_for_depth
from tests.browser.opening import launched
from tests.pictures.calm import find_alarms, take_calm
from tests.pictures.manual import LIT
from tests.pictures.stages import name_numbers
from tests.pictures.views import STREAMED
from tests.stack import Stack
from tests.waiting import wait_for

WINDOW: ViewportSize = {"width": 1280, "height": 720}
RATE = 25
CRF, PRESET = "27", "slow"
"""Of x264: a minute takes less than 3 MB."""
JPEG_QUALITY = 92
CAPTION_SECONDS = 1.0
"""Time in which a caption can be read before the page goes on."""
CAPTIONED = """() => {
    const caption = document.createElement('p');
    caption.id = 'film-caption';
    caption.style.cssText = `position: fixed; z-index: 1000; left: 50%; bottom: 28px; translate: -50% 0;
        padding: 10px 22px; border-radius: 10px; background: rgb(4 12 18 / 0.86); color: white;
        font: 500 23px/1.35 Inter, sans-serif; text-align: center; white-space: nowrap; pointer-events: none`;
    const pointer = document.createElement('i');
    pointer.style.cssText = `position: fixed; z-index: 1001; width: 22px; height: 22px; border-radius: 50%;
        margin: -11px 0 0 -11px; border: 2px solid white; background: rgb(255 255 255 / 0.35);
        pointer-events: none`;
    document.documentElement.append(caption, pointer);
    const follow = ({ clientX, clientY }) => {
        [pointer.style.left, pointer.style.top] = [`${clientX}px`, `${clientY}px`];
    };
    addEventListener('pointermove', follow, true);
    addEventListener('pointerdown', () => (pointer.style.background = 'rgb(255 198 92 / 0.9)'), true);
    addEventListener('pointerup', () => (pointer.style.background = 'rgb(255 255 255 / 0.35)'), true);
}"""
"""A line for captions, and a pointer, which Chromium without a window does not draw."""
POSTER_SHOT = 3
"""The shot of whose end the poster is."""

Frame = NDArray[np.uint8]


class Screencast:
    """The page's pictures as Chromium draws them, in shots that follow each other in the film."""

    def __init__(self, page: Page) -> None:
        self.shots: list[tuple[float, float]] = []
        """Begin and end of each, s since the epoch."""
        self._page = page
        self._frames: list[tuple[float, bytes]] = []
        self._chromium = page.context.new_cdp_session(page)
        self._chromium.on("Page.screencastFrame", self._take)
        self._chromium.send(
            "Page.startScreencast",
            {
                "format": "jpeg",
                "quality": JPEG_QUALITY,
                "maxWidth": WINDOW["width"],
                "maxHeight": WINDOW["height"],
            },
        )

    @contextmanager
    def shot(self, caption: str) -> Iterator[None]:
        """Take as a shot what happens meanwhile, with this caption."""
        self._page.evaluate("(text) => (document.querySelector('#film-caption').textContent = text)", caption)
        begun = time.time()
        yield
        self.shots.append((begun, time.time()))

    def frames(self, shot: tuple[float, float]) -> Iterator[Frame]:
        """Yield a shot's pictures, RATE in a second."""
        begun, ended = shot
        shown = 0
        for number in range(round((ended - begun) * RATE)):
            while shown + 1 < len(self._frames) and self._frames[shown + 1][0] <= begun + number / RATE:
                shown += 1
            frame = cv2.imdecode(np.frombuffer(self._frames[shown][1], np.uint8), cv2.IMREAD_COLOR)
            assert frame is not None
            yield frame.astype(np.uint8)

    def _take(self, event: dict[str, Any]) -> None:
        self._frames.append((event["metadata"]["timestamp"], b64decode(event["data"])))
        self._chromium.send("Page.screencastFrameAck", {"sessionId": event["sessionId"]})


def play(page: Page, stack: Stack, camera: Screencast) -> list[str]:
    """Dive, look at the recording, and at a sweep. Where the dive has alarms, end and return them."""

    def wait(seconds: float) -> None:
        page.wait_for_timeout(1000 * seconds)

    with camera.shot("µ-CAT: a robot turtle that swims with four fins"):
        wait(3.5)
    with camera.shot("Hold to arm: the real firmware, on an emulated chip, in simulated water"):
        point(page, page.get_by_role("button", name="Hold to arm"))
        hold_to_arm(page)
        wait_for_depth(page, 0.4, 0.6)
        wait(1)
    with camera.shot("Show it a yellow card: it dives to one metre"):
        wait(CAPTION_SECONDS)
        press(page, page.get_by_role("button", name="yellow", exact=True))
        wait_for_depth(page, 0.9, 1.1)
    page.keyboard.press("v")
    expect(page.get_by_role("toolbar", name="Flight view")).to_be_visible()
    with camera.shot("Fly by its picture"):
        wait(6)
    with camera.shot("or watch it from outside"):
        press(page, page.get_by_role("button", name="Swap: show the bystander large"))
        wait(5)
    with camera.shot("STOP is always in sight, and stops the fins at once"):
        wait(CAPTION_SECONDS)
        press(page, page.get_by_role("button", name="STOP"))
        wait(3)
    if alarms := find_alarms(stack):
        return alarms
    page.goto(f"{stack.url}/#/operate")
    wait_for_depth(page, -0.1, 0.1)
    session = max(
        document["id"] for document in stack.api.get("/sessions").json() if document["origin"] == "arming"
    )
    wait_for(
        lambda: stack.api.get(f"/sessions/{session}").json()["state"] == "complete", "the recording's end"
    )
    page.goto(f"{stack.url}/#/sessions/{session}")
    curve = page.get_by_role("slider", name="Depth over time")
    expect(curve).to_be_visible()
    wait(CAPTION_SECONDS)
    with camera.shot("Every dive is recorded. Its page tells what happened, and when"):
        sweep_over(page, curve, 8)
    numbers = name_numbers(stack)
    page.goto(f"{stack.url}/#/scenarios/sweeps/{numbers['sweep']}")
    cells = page.get_by_role("gridcell", name="kp")
    expect(cells.first).to_be_visible()
    wait(CAPTION_SECONDS)
    with camera.shot("Sweeps try many gains in simulated time, and say which are the best"):
        for number in (6, 13, 18, 16):
            wait(1)
            press(page, cells.nth(number))
        wait(2)
    with camera.shot("No robot needed:  make run"):
        wait(3)
    return []


def point(page: Page, target: Locator) -> None:
    """Move the pointer to the middle of it, as a hand does."""
    box = target.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, steps=20)


def press(page: Page, target: Locator) -> None:
    point(page, target)
    target.click()


def sweep_over(page: Page, target: Locator, seconds: float) -> None:
    """Move the pointer from its left to its right."""
    box = target.bounding_box()
    assert box is not None
    begun = time.time()
    while (share := (time.time() - begun) / seconds) < 1:
        page.mouse.move(box["x"] + box["width"] * (0.05 + 0.85 * share), box["y"] + box["height"] / 2)
        page.wait_for_timeout(40)


def write_film(camera: Screencast, file: Path) -> None:
    """Write all shots, one after the other, as H.264 in MP4."""
    with av.open(str(file), "w", options={"movflags": "+faststart"}) as film:
        stream = film.add_stream("libx264", rate=RATE, options={"crf": CRF, "preset": PRESET})
        stream.width, stream.height, stream.pix_fmt = WINDOW["width"], WINDOW["height"], "yuv420p"
        for shot in camera.shots:
            for frame in camera.frames(shot):
                film.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="bgr24")))
        film.mux(stream.encode(None))


def write_poster(camera: Screencast, file: Path) -> None:
    """Write the end of a shot, with the sign of a film on it."""
    *_, frame = camera.frames(camera.shots[POSTER_SHOT])
    poster = np.ascontiguousarray(frame)
    x, y = WINDOW["width"] // 2, WINDOW["height"] // 2
    veiled = cv2.circle(poster.copy(), (x, y), 62, (24, 16, 8), -1, cv2.LINE_AA)
    poster = cv2.addWeighted(veiled, 0.7, poster, 0.3, 0).astype(np.uint8)
    triangle = np.array([[x - 20, y - 32], [x - 20, y + 32], [x + 36, y]])
    cv2.fillPoly(poster, [triangle], (255, 255, 255), cv2.LINE_AA)
    cv2.imwrite(str(file), poster, [cv2.IMWRITE_JPEG_QUALITY, 80])


def make_film(data: Path, file: Path, poster: Path) -> None:
    """Dive on a robot with this data folder, and write what is seen."""

    def take() -> list[str]:
        camera, alarms = record(data)
        if not alarms:
            write_film(camera, file)
            write_poster(camera, poster)
            seconds = sum(end - begin for begin, end in camera.shots)
            print(f"{file}: {seconds:.0f} s, {file.stat().st_size / 1e6:.1f} MB")  # noqa: T201 - it is run from a shell
        return alarms

    take_calm(take)


def record(data: Path) -> tuple[Screencast, list[str]]:
    """Play it on a robot with this data folder; return all that was seen, and the dive's alarms."""
    with Stack(data) as stack, launched() as browser:
        context = browser.new_context(viewport=WINDOW, color_scheme="dark")
        sign_in(context, stack.url, stack.data)
        context.add_init_script(LIT)
        page = context.new_page()
        page.goto(f"{stack.url}/#/operate")
        expect(page.get_by_role("button", name="Control: you have control")).to_be_visible()
        page.wait_for_function(STREAMED)
        page.evaluate(CAPTIONED)
        camera = Screencast(page)
        return camera, play(page, stack, camera)
