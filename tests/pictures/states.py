"""States of the robot in which the manual shows it."""

from collections.abc import Callable

from playwright.sync_api import Page

from robot_runtime.missions.library import shipped_missions
from tests.browser.bringing_up import wait_for_the_robot
from tests.browser.driving import wait_for_depth
from tests.stack import Stack
from tests.waiting import wait_for

State = Callable[[Stack, Page], None]
"""Brings a robot at the surface into it; the page of a viewer shows the depth."""
DEPTH = 0.5
STEP = {"kind": "step", "start": 0.4, "target": 0.7, "tolerance": 0.05, "settle": 10, "duration": 10} | {
    "low": 0.0,
    "high": 1.2,
}
TUNED = ("pid", "predictive")
EXPERIMENT_SECONDS = 90.0


def rest(stack: Stack, watcher: Page) -> None:
    """Bring it back to the surface, whatever it does."""
    if stack.api.get("/bring-up").json()["phase"] != "idle":
        wait_for_the_robot(stack)
    stack.api.post("/robot/commands/card", json={"colour": None}).raise_for_status()
    stack.calm()
    # The shell may have taken it from a page.
    stack.api.post("/control/release").raise_for_status()
    wait_for_depth(watcher, -0.1, 0.05)


def swim(stack: Stack, watcher: Page) -> None:
    """Have it hold its depth before a card."""
    _choose(stack, "predictive")
    stack.arm()
    stack.api.post(
        "/robot/commands/parameters", json={"values": {"vision.colour": "green"}}
    ).raise_for_status()
    stack.api.post("/robot/commands/card", json={"colour": "green"}).raise_for_status()
    wait_for_depth(watcher, 2 * DEPTH - 0.1, 2 * DEPTH + 0.1)
    stack.api.post("/robot/commands/acknowledge").raise_for_status()


def tune(stack: Stack, _: Page) -> None:
    """Measure the step of two controllers; it is disarmed afterwards."""
    stack.arm()
    for controller in TUNED:
        _choose(stack, controller)
        stack.api.post("/tuning/runs", json=STEP).raise_for_status()
        wait_for(
            lambda: stack.api.get("/tuning/state").json()["active"] is None, "the step", EXPERIMENT_SECONDS
        )
    stack.api.post("/robot/stop").raise_for_status()


def begin_mission(stack: Stack, watcher: Page) -> None:
    """Have it hold the first of two depths."""
    text = shipped_missions()["two_depths"]
    stack.api.post("/missions/start", json={"text": text}, timeout=30.0).raise_for_status()
    wait_for_depth(watcher, DEPTH, 2 * DEPTH)


def _choose(stack: Stack, controller: str) -> None:
    request = {"name": "depth", "controller": controller}
    stack.api.post("/robot/commands/loop", json=request).raise_for_status()
