"""The way by dead reckoning on Operate: an estimate, in view while a mission runs, gone with its end."""

import pytest
from playwright.sync_api import Browser, StorageState, ViewportSize, expect

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.documents import Mission, MissionStepState, Track
from robot_runtime.contract.missions import MissionPhase
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents, row
from tests.browser.opening import DESKTOP, PHONE, unopened_page
from tests.pages.dive_site import DiveSite
from tests.pages.flying import Flown

STEPS = 20
"""More than there is room for."""
ELAPSED = 10.0
"""s from the mission's start."""
DEVIATIONS = (0.1, 0.4)
"""m at each piece of the way."""


def mission(phase: MissionPhase) -> Block:
    """Return the block of a mission with many steps."""
    steps = [
        MissionStepState(
            path=str(number) if number else "",
            do="sequence" if number == 0 else "hold",
            words=f"step {number}",
            note="",
            status="running" if number < 2 else "waiting",
            elapsed=1.0,
            longest=10.0,
            rounds=0,
            text="",
        )
        for number in range(STEPS)
    ]
    state = Mission(
        time=SteadyClock().now(),
        number=1,
        sequence=0,
        name="lanes",
        title="Lanes",
        phase=phase,
        text="",
        elapsed=ELAPSED,
        remaining=100.0,
        progress=0.1,
        paused=0.0,
        pause=60.0,
        deepest=0.5,
        steps=steps,
    )
    return Block.of(BY_NAME["mission"], 1, 0, pack_documents([state]))


def way(number: int) -> Block:
    """Return the block of one estimate of the way; later ones are less certain."""
    deviation = DEVIATIONS[number]
    estimate = Track(x=1.0 + number, y=0.5, deviation_x=deviation, deviation_y=deviation / 2)
    return Block.of(BY_NAME["track"], 1, number, row(SteadyClock().now(), estimate.to_bytes()))


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_the_way_is_in_view_while_a_mission_runs(
    browser: Browser, site: DiveSite, cookies: StorageState, size: ViewportSize
) -> None:
    with unopened_page(browser, cookies, size) as page:
        flown = Flown(page)
        flown.mode = "automatic"
        page.goto(f"{site.url}/#/operate")
        # A mission of a robot that is not armed has broken off.
        expect(page.get_by_role("region", name="Arm", exact=True).get_by_text("Armed")).to_be_visible()
        flown.send(way(0))
        flown.send(mission("running"))
        panel = page.get_by_role("region", name="Mission")
        drawing = panel.get_by_role("img", name="The way from above, by dead reckoning")
        if size == PHONE:
            panel.scroll_into_view_if_needed()
        expect(drawing).to_be_in_viewport(ratio=1)
        box = drawing.bounding_box()
        assert box is not None
        assert box["height"] >= 80
        expect(panel.get_by_text("estimate by dead reckoning")).to_be_in_viewport(ratio=1)
        expect(panel.get_by_text("± 0.2 m")).to_be_visible()
        expect(panel.locator('[data-path="1"] > .row')).to_be_in_viewport(ratio=1)
        flown.send(way(1))
        expect(panel.get_by_text("± 0.8 m")).to_be_visible()
        flown.mode = "disarmed"
        flown.send(mission("succeeded"))
        expect(panel.get_by_role("status")).to_have_text("Succeeded")
        expect(drawing).to_have_count(0)
