"""The page of sweeps: list, plan, progress, results and what is made of them."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.axe import AXE, faults_in_both_themes
from tests.browser.code import write_code
from tests.browser.opening import DESKTOP, PHONE, opened_page, signed_in
from tests.pages.dive_site import DiveSite, recorded_site
from tests.pages.stored_sweeps import (
    BEST,
    CANCELLED,
    GRID,
    KD,
    KP,
    LINE,
    NEVER_ARMED,
    WITHOUT_FIGURES,
    store_sweeps,
    text_of,
)

TOML = "Sweep as TOML"


@pytest.fixture(scope="module")
def sweeps(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DiveSite]:
    """A server with three sweeps, none of which runs."""
    with recorded_site(tmp_path_factory.mktemp("data"), store_sweeps) as site:
        yield site


@pytest.fixture(params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def page(request: pytest.FixtureRequest, browser: Browser, sweeps: DiveSite) -> Iterator[Page]:
    with opened_page(browser, sweeps, signed_in(browser, sweeps), request.param) as page:
        yield page


def cell(page: Page, kp: int, kd: int) -> Locator:
    """Return a place of the map of kp, in 1/m, and kd, in s/m."""
    return page.get_by_role("gridcell", name=re.compile(rf"^kp .1.m. {kp}, kd .s.m. {kd}: "))


def overflow(page: Page) -> int:
    return int(page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth"))


def test_a_grid_is_read_by_colour_by_keys_and_as_a_table(page: Page, sweeps: DiveSite) -> None:
    page.goto(f"{sweeps.url}/#/scenarios")
    page.get_by_role("link", name="Sweeps", exact=True).click()
    page.get_by_role("link", name="PID in a current").click()
    best = cell(page, 10, 2)
    expect(best).to_have_attribute("aria-label", re.compile("0.0240 m, best"))
    expect(best).to_have_attribute("aria-selected", "true")
    panel = page.get_by_role("region", name=f"Best: variant {BEST}")
    # Seeds shift all variants alike: what tells them apart are the differences of equal seeds.
    expect(panel).to_contain_text("Better than the next, variant")
    expect(panel).to_contain_text("This is sure though the intervals of both means overlap")
    expect(panel.get_by_role("row")).to_have_count(4)

    # By keys, and the address follows; the figure of a variant without one is said in words.
    best.focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")
    expect(cell(page, 10, 4)).to_have_attribute("aria-selected", "true")
    expect(page).to_have_url(re.compile("variant=6"))
    failing = cell(page, 30, 4)
    expect(failing).to_have_attribute("aria-label", re.compile("all runs failed"))
    failing.click()
    failed = page.get_by_role("region", name=f"Variant {WITHOUT_FIGURES}")
    expect(failed).to_contain_text(NEVER_ARMED)
    expect(page.get_by_role("region", name="Failed runs", exact=True)).to_contain_text(NEVER_ARMED)
    failed.get_by_role("button", name="Show the best").click()
    expect(panel).to_be_visible()

    page.get_by_label("Figure", exact=True).select_option("Overshoot")
    page.get_by_label("Across", exact=True).select_option("kd (s/m)")
    expect(page).to_have_url(re.compile(f"figure=overshoot.*x={KD}"))
    table = page.get_by_role("table", name="All variants")
    expect(table.get_by_role("row")).to_have_count(13)
    table.get_by_role("radio", name="Show variant 1", exact=True).check()
    page.reload()
    expect(page.get_by_role("region", name="Variant 1", exact=True)).to_be_visible()
    expect(page.get_by_label("Up", exact=True)).to_have_value(KP)
    assert overflow(page) == 0


def test_one_gain_is_a_line_and_its_gains_become_a_profile(page: Page, sweeps: DiveSite) -> None:
    page.goto(f"{sweeps.url}/#/scenarios/sweeps/{LINE}")
    expect(page.get_by_role("img", name=re.compile("^RMSE by kp"))).to_be_visible()
    expect(page.locator(".js-plotly-plot .point")).to_have_count(16)
    page.get_by_role("button", name="Save these gains as a profile").click()
    page.get_by_label("Name of the profile").fill("calm")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Saved as “calm”.")).to_be_visible()
    (saved,) = [profile for profile in sweeps.api.get("/profiles").json() if profile["name"] == "calm"]
    sweeps.api.delete(f"/profiles/{saved['id']}").raise_for_status()
    assert overflow(page) == 0


def test_a_sweep_is_planned_and_its_problems_stand_in_their_lines(page: Page, sweeps: DiveSite) -> None:
    page.goto(f"{sweeps.url}/#/scenarios/sweeps/new")
    box = page.get_by_role("textbox", name=TOML)
    expect(box).to_contain_text("[vary]")
    start = page.get_by_role("button", name="Start the sweep")
    expect(start).to_be_enabled()
    write_code(box, text_of("A plan", kp=(5.0, 10.0), kd=(1.0, 2.0)))
    plan = page.get_by_role("region", name="To be done")
    expect(plan).to_contain_text("12 runs")
    expect(plan).to_contain_text("4 variants × 3 seeds")
    write_code(box, text_of("A plan", kp=(5.0, 10.0), kpp=(1.0,)))
    expect(page.get_by_role("list", name="Problems")).to_contain_text("kpp")
    expect(start).to_be_disabled()
    write_code(box, text_of("A plan", kp=(5.0, 10.0)) + 60_000 * "#")
    expect(page.get_by_text(re.compile("there can be 60.000 at most"))).to_be_visible()
    expect(start).to_be_disabled()
    page.get_by_label("Begin with").select_option("figure_14")
    page.get_by_role("button", name="Use", exact=True).click()
    expect(box).to_contain_text("figure_14")
    expect(start).to_be_enabled()
    page.get_by_role("button", name="Undo").click()
    expect(box).to_contain_text("A plan")
    assert overflow(page) == 0


def test_no_view_of_sweeps_has_a_serious_violation(page: Page, sweeps: DiveSite) -> None:
    page.evaluate(AXE.read_text())
    for address in ("", f"/{GRID}", f"/{LINE}", f"/{GRID}?variant={WITHOUT_FIGURES}", f"/{CANCELLED}"):
        page.goto(f"{sweeps.url}/#/scenarios/sweeps{address}")
        expect(page.get_by_text(re.compile("Loading…|Checking…"))).to_have_count(0)
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        assert faults_in_both_themes(page) == [], address


def test_without_a_sweep_a_scenario_is_offered_to_begin_with(any_page: Page, site: DiveSite) -> None:
    for sweep in site.api.get("/sweeps").json():
        site.api.delete(f"/sweeps/{sweep['id']}").raise_for_status()
    any_page.goto(f"{site.url}/#/scenarios/sweeps")
    expect(any_page.get_by_text("No sweep yet")).to_be_visible()
    any_page.get_by_label("Scenario", exact=True).select_option("Hover in a current")
    any_page.get_by_role("button", name="Begin").click()
    expect(any_page.get_by_role("textbox", name=TOML)).to_contain_text("hover_in_a_current")
