"""Sound: chosen in the page's settings, remembered, and said where the browser has none."""

from playwright.sync_api import Browser, Page, StorageState, expect

from tests.browser.opening import DESKTOP
from tests.pages.dive_site import DiveSite

WITHOUT = """
delete window.AudioContext;
delete window.speechSynthesis;
navigator.vibrate = () => { throw new Error("denied") };
"""


def test_sound_is_off_until_it_is_chosen_and_then_remembered(page: Page) -> None:
    page.get_by_role("button", name="Page settings").click()
    sound = page.get_by_role("group", name="Sound")
    expect(sound.get_by_label("Off")).to_be_checked()
    sound.get_by_text("Low").click()
    page.get_by_label("Spoken words").check()
    page.reload()
    page.get_by_role("button", name="Page settings").click()
    expect(sound.get_by_label("Low")).to_be_checked()
    expect(page.get_by_label("Spoken words")).to_be_checked()


def test_a_browser_without_sound_says_so_and_works(
    browser: Browser, site: DiveSite, cookies: StorageState
) -> None:
    context = browser.new_context(viewport=DESKTOP, storage_state=cookies)
    context.add_init_script(WITHOUT)
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(site.first)
    page.get_by_role("button", name="Page settings").click()
    page.get_by_role("group", name="Sound").get_by_text("Full").click()
    page.get_by_label("Spoken words").check()
    expect(page.get_by_role("dialog").get_by_text("This browser plays no tones.")).to_be_visible()
    assert complaints == []
    context.close()
