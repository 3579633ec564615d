"""All pages, and their addresses."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from playwright.sync_api import Page, expect

from server.platform.settings import DataFolder
from tests.browser.site import Site
from tests.server.features.sweeps.sweep_rig import keep_scenario
from tests.waiting import wait_for

SESSIONS = ("Dive to half a metre", "Half a metre with PID")
"""{first} and {second} in the addresses."""

SWEEP = """
format = 1
name = "still_water"
title = "Gains in still water"
scenario = "short"
seeds = 2
[vary]
"control.gains.pid.kp" = [2.0, 4.0]
"control.gains.pid.kd" = [1.0, 2.0]
"""


@dataclass(frozen=True, slots=True)
class View:
    """One page. `address` follows the # and may name two sessions, {first} and {second}, a {moment} (s) of
    the first, a test's {run} and a {sweep}; `shows` is in a heading that says that it is there."""

    name: str
    address: str
    shows: str


PAGES = (
    View("operate", "operate", "Camera"),
    View("tune-bench", "tune/bench", "Tune"),
    View("tune-parameters", "tune/parameters", "Tune"),
    View("tune-craft", "tune/craft", "Tune"),
    View("tune-vision", "tune/vision", "Tune"),
    View("missions", "missions", "Library"),
    View("mission", "missions/edit/two_depths", "Two depths"),
    View("scenarios", "scenarios", "New run"),
    View("sweeps", "scenarios/sweeps", "Sweeps"),
    View("new-sweep", "scenarios/sweeps/new", "New sweep"),
    View("sweep", "scenarios/sweeps/{sweep}", "Gains in still water"),
    View("comm-tests", "comm-tests", "Runs"),
    View("comm-test", "comm-tests/runs/{run}", "All cells"),
    View("comm-tests-compare", "comm-tests/compare/table6/{run}", "Compare runs"),
    View("sessions", "sessions", "Recorded"),
    View("session", "sessions/{first}", "Figures"),
    View("session-data", "sessions/{first}/data", "Export"),
    View("sessions-compare", "sessions/compare/{first},{second}", "Over time"),
    View("replay", "replay/{first}/{moment}", "of Dive to half"),
    View("system", "system", "Parts"),
    View("gamepads", "gamepads", "Gamepads"),
    View("people", "people", "Browsers and programs"),
    View("bring-up", "bring-up", "Bring-up"),
)

LIVE = tuple(page for page in PAGES if page.address.startswith(("operate", "tune", "system")))
"""Those that show the state of the robot."""


def fill(site: Site) -> None:
    """Ensure that two sessions exist."""
    there = {session["name"] for session in site.api.get("/sessions").json()}
    for name in SESSIONS:
        if name in there:
            continue
        session = site.api.post("/sessions", json={"name": name}).raise_for_status().json()["id"]
        site.api.post(f"/sessions/{session}/markers", json={"text": "here"}).raise_for_status()
        wait_for(lambda: "depth" in topics(site, session), "samples of depth")  # noqa: B023 - it is called here
        site.api.post(f"/sessions/{session}/stop").raise_for_status()


def topics(site: Site, session: int) -> set[str]:
    """Return the names of the topics of which a session holds samples."""
    return {topic["name"] for topic in site.api.get(f"/sessions/{session}").json()["topics"]}


def samples(site: Site, session: int) -> int:
    """Number of samples that a session holds."""
    return int(site.api.get(f"/sessions/{session}").json()["samples"])


def show(page: Page, site: Site, view: View) -> None:
    """Open a page, and wait until its contents are shown."""
    there = {session["name"]: session for session in site.api.get("/sessions").json()}
    first, second = (there[name] for name in SESSIONS)
    names = {
        "sweep": find_sweep(site) if "{sweep}" in view.address else "",
        "first": first["id"],
        "second": second["id"],
        "moment": f"{first['duration'] / 2:.1f}",
        "run": site.api.get("/comm-tests/runs").json()[0]["id"],
    }
    page.goto(f"{site.url}/#/{view.address.format(**names)}")
    expect(page.get_by_role("heading", name=re.compile(view.shows)).first).to_be_visible()
    settle(page)


@contextmanager
def short_scenario(site: Site) -> Iterator[None]:
    """Have a scenario of 12 s in the library for a while."""
    folder = DataFolder(site.data).scenarios
    keep_scenario(folder)
    yield
    (folder / "short.toml").unlink()


def find_sweep(site: Site) -> int:
    """Return a sweep that is complete; without one it is computed, which takes a few seconds."""

    def listed() -> list[dict[str, Any]]:
        sweeps: list[dict[str, Any]] = site.api.get("/sweeps").json()
        return [sweep for sweep in sweeps if sweep["name"] == "still_water"]

    if not listed():
        with short_scenario(site):
            site.api.post("/sweeps", json={"text": SWEEP}).raise_for_status()
    wait_for(lambda: listed()[0]["state"] == "complete", "the end of the sweep")
    return int(listed()[0]["id"])


def settle(page: Page) -> None:
    """Wait until no element of the page is busy."""
    expect(
        page.get_by_text(re.compile("being (fetched|read|compared|checked)|(Loading|Checking)…"))
    ).to_have_count(0)


def stop_recordings(site: Site) -> None:
    """End the recording of a session, if there is one."""
    for session in site.api.get("/sessions").json():
        if session["state"] == "recording":
            # Refused where it has just ended by itself, as that of an arming does.
            site.api.post(f"/sessions/{session['id']}/stop")
