"""`python -m tests.browser.screenshots FOLDER`: every page, both sizes, both themes, of a robot in operation.

The flight view also on a phone that lies.

docs/pictures has a few of them: copy one there only when what it shows has changed.
"""

import re
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import Browser, Page, expect, sync_playwright

from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.browser.driving import wait_for_depth
from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE
from tests.browser.pages import PAGES, SESSIONS, settle, show
from tests.browser.people import somebody
from tests.stack import Stack
from tests.waiting import wait_for

SIZES = {"desktop": (DESKTOP, 1.0), "phone": (PHONE, 1.5), "lying": (LYING_PHONE, 1.5)}
"""The window, and dots for each of its pixels."""
QUALITY = 50
"""Of the JPEG: letters stay sharp, and a picture takes less than 90 kB."""
SHOWN = """() => [...document.images].every((one) => {
    const { left, top } = one.getBoundingClientRect();
    return one.complete || left > innerWidth || top > innerHeight;
})"""
"""Whether all pictures in the window are there; others are fetched when they come into it."""
STREAMED = "() => [...document.images].some((one) => one.naturalWidth === 640)"
CONTROLLERS = ("bang_bang", "pid")
TUNED = ("pid", "predictive")
DEPTH = 0.5
LIMITS = {"low": 0.0, "high": 1.2}
STEP = {"kind": "step", "start": 0.4, "target": 0.7, "tolerance": 0.05, "settle": 10, "duration": 10} | LIMITS
RELAY = {"kind": "relay", "set_point": 0.6, "amplitude": 1.0, "hysteresis": 0.01, "cycles": 3, "duration": 60}


def choose(stack: Stack, controller: str) -> None:
    """Steer the depth by this controller."""
    request = {"name": "depth", "controller": controller}
    stack.api.post("/robot/commands/loop", json=request).raise_for_status()


def tune_parameters(stack: Stack, **values: float | str) -> None:
    """Set parameters by their names."""
    stack.api.post("/robot/commands/parameters", json={"values": values}).raise_for_status()


def dive(stack: Stack, watcher: Page, name: str, controller: str) -> None:
    """Record a dive from the surface."""
    choose(stack, controller)
    session = stack.api.post("/sessions", json={"name": name, "note": "still water"}).json()["id"]
    stack.arm()
    wait_for_depth(watcher, DEPTH - 0.1, DEPTH)
    stack.api.post(f"/sessions/{session}/markers", json={"text": "nearly there"}).raise_for_status()
    for _ in range(3):
        wait_for_depth(watcher, DEPTH, 1.0)
        wait_for_depth(watcher, 0.0, DEPTH)
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    stack.api.post("/robot/stop").raise_for_status()
    stack.api.patch(f"/sessions/{session}", json={"tags": ["pool"]}).raise_for_status()
    wait_for_depth(watcher, -0.1, 0.05)


def tune(stack: Stack) -> None:
    """A step response of two controllers, and a relay experiment."""
    stack.arm()
    for controller in TUNED:
        choose(stack, controller)
        experiment(stack, STEP)
    experiment(stack, RELAY | LIMITS)
    stack.api.post("/robot/stop").raise_for_status()


def experiment(stack: Stack, request: dict[str, object]) -> None:
    stack.api.post("/tuning/runs", json=request).raise_for_status()
    wait_for(lambda: stack.api.get("/tuning/state").json()["active"] is None, "the experiment to end", 90.0)


def prepare(stack: Stack, watcher: Page) -> None:
    """Experiments, two sessions that can be compared, and a robot that swims and records."""
    tune(stack)
    wait_for_depth(watcher, -0.1, 0.05)
    tune_parameters(stack, **{"control.set_point": DEPTH})
    for name, controller in zip(SESSIONS, CONTROLLERS, strict=True):
        dive(stack, watcher, name, controller)
    stack.api.post("/sessions", json={"name": "Hovering", "note": ""}).raise_for_status()
    stack.arm()
    tune_parameters(stack, **{"vision.colour": "green"})
    stack.api.post("/robot/commands/card", json={"colour": "green"}).raise_for_status()
    wait_for_depth(watcher, DEPTH - 0.05, 1.0)


def take(browser: Browser, stack: Stack, folder: Path) -> None:
    """Write NAME-SIZE-THEME.jpg for every page, and for the flight view."""
    for size, (window, dots) in SIZES.items():
        for theme in ("dark", "sunlight"):
            context = browser.new_context(
                viewport=window,
                device_scale_factor=dots,
                has_touch=size != "desktop",
                reduced_motion="reduce",
            )
            sign_in(context, stack.url, stack.data)
            context.add_init_script(f"localStorage.setItem('mucat-theme', '{theme}')")
            page = context.new_page()
            page.goto(stack.url)
            expect(page.get_by_role("button", name=re.compile("^Control: you have control"))).to_be_visible()
            for view in PAGES if size != "lying" else ():
                show(page, stack, view)
                write(page, folder / f"{view.name}-{size}-{theme}.jpg")
            page.goto(f"{stack.url}/#/flight")
            # The stream of the camera is on its way, too.
            page.wait_for_function(STREAMED)
            write(page, folder / f"flight-{size}-{theme}.jpg")
            context.close()


def write(page: Page, path: Path) -> None:
    """Write a picture of the page once everything is drawn."""
    draw(page)
    path.write_bytes(page.screenshot(type="jpeg", quality=QUALITY))
    print(f"{path}: {path.stat().st_size / 1000:.0f} kB")  # noqa: T201 - it is run from a shell


def draw(page: Page) -> None:
    """Wait until pictures and charts are there."""
    settle(page)
    expect(page.get_by_text(re.compile("being drawn|Loading charts"))).to_have_count(0)
    page.wait_for_function(SHOWN)
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def main(folder: Path) -> None:
    """Start a robot, arm it, and take the pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix="mucat-") as data, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        with Stack(Path(data) / "data") as stack:
            # A viewer, who leaves control to what prepares it.
            with somebody(browser, stack, "viewer") as watcher:
                prepare(stack, watcher)
            take(browser, stack, folder)
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
