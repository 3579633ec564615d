"""The views of the page Tune that need no robot."""

import json
import re
from typing import Any

from playwright.sync_api import Page, Route, WebSocketRoute, expect

from tests.pages.dive_site import DiveSite

STEP = {"kind": "step", "loop": "depth", "start": 0.4, "target": 0.7, "tolerance": 0.03} | {
    "settle": 10.0,
    "duration": 4.0,
    "low": 0.0,
    "high": 1.5,
}


def stored(run: int, kp: float) -> dict[str, Any]:
    """Return a stored run whose value goes to the target in a second, and overshoots it."""
    mark = {"start": 0.1, "end": 0.9, "low": 0.43, "high": 0.67}
    missing = {"value": None, "words": "", "mark": None}
    return {
        "id": run,
        "name": f"PID {kp}",
        "kind": "step",
        "loop": "depth",
        "started": "2026-05-04T10:00:00Z",
        "state": "complete",
        "problem": "",
        "settings": STEP,
        "force": {"controller": "pid", "title": "PID", "gains": {"kp": kp}},
        "figures": {"rise_time": {"value": 0.8, "words": "", "mark": mark}, "overshoot": missing},
        "cycle": None,
        "proposals": [],
        "curve": {
            "times": [-1.0, 0.0, 1.0, 2.0, 4.0],
            "set_points": [0.4, 0.7, 0.7, 0.7, 0.7],
            "values": [0.4, 0.4, 0.7, 0.75, 0.7],
            "outputs": [0.0, 1.0, 0.2, -0.2, 0.1],
        },
    }


def test_the_address_of_the_bench_names_its_loop(page: Page, site: DiveSite) -> None:
    page.goto(f"{site.url}/#/tune/bench/heading")
    expect(page.get_by_role("heading", name="Heading after the step")).to_be_visible()
    page.goto(f"{site.url}/#/tune")
    expect(page.get_by_role("heading", name="Depth after the step")).to_be_visible()


def test_gains_are_tried_against_the_prediction_and_kept(any_page: Page, site: DiveSite) -> None:
    page = any_page
    page.goto(f"{site.url}/#/tune/bench")
    with page.expect_response("**/api/tuning/prediction") as predicted:
        page.get_by_role("combobox", name="Controller").select_option("pid")
    assert predicted.value.json()["model"] == "Default craft"
    expect(page.get_by_text("prediction (Default craft)")).to_be_visible()
    with page.expect_response("**/api/tuning/prediction") as predicted:
        page.get_by_role("spinbutton", name="kp").fill("12")
    assert predicted.value.ok
    expect(page.get_by_role("slider", name="kp")).to_have_attribute("aria-valuetext", "12 1/m")
    page.get_by_role("spinbutton", name="kp").fill("5000")
    expect(page.get_by_role("button", name="Keep")).to_be_disabled()
    page.get_by_role("button", name="Back", exact=True).click()
    expect(page.get_by_role("button", name="Back", exact=True)).to_be_disabled()

    page.get_by_role("combobox", name="Controller").select_option("pid")
    page.get_by_role("spinbutton", name="kp").fill("12")
    page.get_by_role("button", name="Keep").click()
    expect(page.get_by_label("Save as profile…")).to_be_visible()
    name, asked = site.commands[-1]
    assert name == "parameters"
    assert asked["values"]["depth.controller"] == "pid"
    assert asked["values"]["depth.pid.kp"] == 12


def test_runs_lie_over_each_other_and_stand_in_the_address(page: Page, site: DiveSite) -> None:
    runs = {1: stored(1, 3.0), 2: stored(2, 8.0)}
    meanings = [
        {
            "name": "rise_time",
            "title": "Rise time",
            "unit": "s",
            "decimals": 2,
            "better": "less",
            "meaning": "m",
        }
    ]

    def answer(route: Route) -> None:
        number = re.search(r"runs/(\d+)", route.request.url)
        route.fulfill(
            json=runs[int(number[1])] if number else {"figures": meanings, "runs": [*runs.values()][::-1]}
        )

    page.route(re.compile("/api/tuning/runs"), answer)
    page.goto(f"{site.url}/#/tune/bench/depth?runs=1")
    table = page.get_by_role("region", name="Runs", exact=True)
    expect(table.get_by_role("checkbox", name="Show #1 PID 3.0")).to_be_checked()
    expect(table.get_by_role("checkbox", name="Show #2 PID 8.0")).not_to_be_checked()
    table.get_by_role("checkbox", name="Show #2 PID 8.0").check()
    figures = page.get_by_role("region", name="Figures of the step responses")
    expect(figures.get_by_role("columnheader")).to_have_count(3)
    page.wait_for_url(re.compile(r"runs=1,2$"))
    table.get_by_role("button", name="#1 PID 3.0", exact=True).click()
    page.wait_for_url(re.compile(r"runs=2,1$"))
    page.reload()
    expect(table.get_by_role("button", name="#1 PID 3.0", exact=True)).to_have_attribute(
        "aria-pressed", "true"
    )
    expect(figures.get_by_role("columnheader")).to_have_count(3)


def test_the_runs_are_asked_for_once_when_one_has_ended(unopened: Page, site: DiveSite) -> None:
    sockets: list[WebSocketRoute] = []

    def join(socket: WebSocketRoute) -> None:
        socket.connect_to_server()
        sockets.append(socket)

    def asked_after(run: int) -> int:
        last = {"id": run, "kind": "step", "loop": "depth"}
        sockets[-1].send(json.dumps({"op": "tuning", "active": None, "last": last}))
        return int(unopened.evaluate("asked"))

    unopened.add_init_script("""
        window.asked = 0;
        const whole = window.fetch;
        window.fetch = (...args) => {
            if (new Request(...args).url.includes('/api/tuning/runs')) window.asked += 1;
            return whole(...args);
        };
    """)
    unopened.route_web_socket(re.compile("/api/live"), join)
    unopened.goto(f"{site.url}/#/tune/bench")
    expect(unopened.get_by_text("No run yet")).to_be_visible()
    first = asked_after(7)
    assert first > 0
    # The server sends the last run with each report of the next one.
    assert [asked_after(run) - first for run in (7, 7, 8)] == [0, 0, 1]
