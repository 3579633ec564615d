"""The exhibit: the robot for visitors, without controls, live and from a session."""

from playwright.sync_api import Browser, expect

from tests.browser.pages import fill
from tests.browser.people import somebody
from tests.pages.dive_site import DiveSite


def test_a_viewer_shows_the_robot_without_controls_until_a_press(browser: Browser, site: DiveSite) -> None:
    with somebody(browser, site, "viewer") as page:
        page.clock.install()
        page.goto(f"{site.url}/#/exhibit")
        expect(page.get_by_text("A robot turtle that swims with four fins")).to_be_visible()
        expect(page.get_by_text("It rests")).to_be_visible()
        expect(page.get_by_role("button", name="STOP")).to_be_hidden()
        expect(page.get_by_role("button")).to_have_count(0)
        page.get_by_text("The turtle as its sensors feel it: a model").wait_for()
        page.clock.run_for(21_000)
        page.get_by_text("Its depth in the last minute").wait_for()

        page.keyboard.press("Shift")
        expect(page.get_by_role("button", name="STOP")).to_be_visible()
        expect(page.get_by_role("button", name="Full screen")).to_be_visible()
        page.clock.run_for(7_000)
        expect(page.get_by_role("button", name="STOP")).to_be_hidden()
        page.mouse.click(300, 300)
        page.get_by_role("link", name="Leave").click()
        expect(page.get_by_role("heading", level=1, name="Operate")).to_be_attached()
        expect(page.get_by_role("button", name="STOP")).to_be_visible()


def test_a_session_is_exhibited(browser: Browser, site: DiveSite) -> None:
    fill(site)
    session = site.api.get("/sessions").json()[0]["id"]
    with somebody(browser, site, "viewer") as page:
        page.goto(f"{site.url}/#/exhibit/{session}")
        expect(page.get_by_text("Recorded ·")).to_be_visible()
        expect(page.get_by_text("m deep")).to_be_visible()
        page.goto(f"{site.url}/#/exhibit/9999")
        expect(page.get_by_text("There is no session 9999")).to_be_visible()
        page.goto(f"{site.url}/#/exhibit/nonsense")
        expect(page.get_by_text("There is no such session.")).to_be_visible()
