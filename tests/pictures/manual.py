"""The manual's pictures of the page; `make screenshots` takes each into docs/pictures."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from playwright.sync_api import Page, ViewportSize

from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE
from tests.browser.site import Site
from tests.pictures import states, views

SIZES: dict[str, ViewportSize] = {
    "screen": DESKTOP,
    "window": {"width": 1280, "height": 800},
    "phone": PHONE,
    "lying phone": LYING_PHONE,
}
LIT = "Object.defineProperty(Navigator.prototype, 'wakeLock', { get: () => ({ request: async () => ({}) }) })"
"""Chromium without a screen refuses to keep it on, and the page would say so."""
Stage = Literal["desk", "robot", "lab"]
"""A server with recordings and a robot at rest; one with a robot that swims; a lab."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ManualPicture:
    """`docs/pictures/NAME.jpg`: the page at this `address`, in which {words} stand for numbers."""

    name: str
    stage: Stage
    address: str
    act: Callable[[Page, Site], None] = views.leave
    state: states.State = states.rest
    """Of the robot; only where the stage has one that swims."""
    size: Literal["screen", "window", "phone", "lying phone"] = "window"
    theme: Literal["dark", "sunlight"] = "dark"


PICTURES = (
    ManualPicture(name="first-dive", stage="robot", address="operate", act=views.be_guided),
    ManualPicture(name="tune-parameters", stage="robot", address="tune/parameters"),
    ManualPicture(
        name="operate", stage="robot", address="operate", state=states.swim, size="screen", act=views.see
    ),
    ManualPicture(
        name="operate-phone", stage="robot", address="operate", state=states.swim, size="phone", act=views.see
    ),
    ManualPicture(
        name="panels",
        stage="robot",
        address="operate",
        state=states.swim,
        size="screen",
        act=views.arrange_panels,
    ),
    ManualPicture(name="flight", stage="robot", address="flight", state=states.swim, act=views.see),
    ManualPicture(
        name="flight-outside", stage="robot", address="flight", state=states.swim, act=views.swap_pictures
    ),
    ManualPicture(name="tune-vision", stage="robot", address="tune/vision", state=states.swim, act=views.see),
    ManualPicture(
        name="exhibit", stage="robot", address="exhibit", state=states.swim, act=views.give_control_away
    ),
    ManualPicture(
        name="mission-phone",
        stage="robot",
        address="operate",
        state=states.begin_mission,
        size="phone",
        act=views.see_mission,
    ),
    ManualPicture(
        name="flight-phone", stage="robot", address="operate", act=views.drive_by_hand, size="lying phone"
    ),
    ManualPicture(
        name="tune-bench", stage="robot", address="tune/bench", state=states.tune, act=views.choose_runs
    ),
    ManualPicture(name="bring-up-axes", stage="robot", address="bring-up", size="screen", act=views.lie_down),
    ManualPicture(name="bring-up-fin", stage="robot", address="bring-up", size="screen", act=views.turn_fin),
    ManualPicture(name="help", stage="desk", address="sessions", act=views.open_help),
    ManualPicture(name="craft", stage="desk", address="tune/craft"),
    ManualPicture(name="mission", stage="desk", address="missions/edit/two_depths", act=views.try_mission),
    ManualPicture(name="scenarios", stage="desk", address="scenarios"),
    ManualPicture(name="scenario", stage="desk", address="scenarios", act=views.write_scenario),
    ManualPicture(name="sweep", stage="desk", address="scenarios/sweeps/{sweep}"),
    ManualPicture(name="comm-test", stage="desk", address="comm-tests/runs/{run}"),
    ManualPicture(name="sessions", stage="desk", address="sessions"),
    ManualPicture(name="session", stage="desk", address="sessions/{pool}?at=36", size="screen"),
    ManualPicture(
        name="session-phone",
        stage="desk",
        address="sessions/{pool}?at=36",
        size="phone",
        theme="sunlight",
        act=views.see_curve,
    ),
    ManualPicture(name="replay", stage="desk", address="replay/{pool}?at=36"),
    ManualPicture(name="compare", stage="desk", address="sessions/compare/{figure},{hover}"),
    ManualPicture(name="export", stage="desk", address="sessions/{pool}/data"),
    ManualPicture(name="lab-robots", stage="lab", address="robots"),
    ManualPicture(name="lab-figures", stage="lab", address="figures?by=controller", act=views.await_figures),
)
"""All pictures of the page, by stage and state: the robot goes through its states in this order."""
SCENE, FILM = "scene", "film"
"""Names of the picture that is rendered without a page, and of the film with its poster."""
ALL = (*(picture.name for picture in PICTURES), SCENE, FILM)
