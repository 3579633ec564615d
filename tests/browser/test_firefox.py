"""The page in a second browser engine: Debian's Firefox signs in, shows live depth, arms and stops."""

from collections.abc import Iterator

import pytest

from tests.browser.conftest import bring_to_surface, put_to_rest
from tests.browser.firefox import Firefox
from tests.browser.pages import PAGES
from tests.browser.people import make_link
from tests.stack import Stack

ESCAPE = "\ue00c"
FLYING = "document.querySelector('h1')?.textContent === 'Flight view'"
PICTURE = "document.querySelector('.stage .picture img')?.naturalWidth > 0"
TAPES = "document.querySelector('.instruments canvas')"
DEEP = "Number(/Depth (.+?) m/.exec(document.querySelector('.drawn').ariaLabel)[1].replace('−', '-')) > 0.2"
DEPTH = "Number([...document.querySelectorAll('.reading')].find((one) => one.textContent.includes('Depth'))"
DEPTH += "?.querySelector('.value')?.textContent.replace('−', '-'))"
CONNECTED = "/\\d:\\d/.test(document.querySelector('.top time')?.textContent)"
"""The page tells the robot's time once it hears from it."""
SHEET = "document.querySelector('.sheet:popover-open') !== null"
VIEWS = [view for view in PAGES if "{" not in view.address]


@pytest.fixture(scope="module")
def firefox(tmp_path_factory: pytest.TempPathFactory, stack: Stack) -> Iterator[Firefox]:
    """Signed in as an operator; what its console complains about fails the last test."""
    bring_to_surface(stack)
    with Firefox(tmp_path_factory.mktemp("profile")) as firefox:
        firefox.open(make_link(stack, "operator"))
        firefox.move_to_button("Sign in")
        firefox.click()
        firefox.wait_for("document.querySelector('.stop')")
        yield firefox
        put_to_rest(stack)
        assert firefox.complaints == []


def test_firefox_dives_and_stops_by_a_key(firefox: Firefox, stack: Stack) -> None:
    firefox.wait_for(f"Math.abs({DEPTH}) < 0.1")
    firefox.wait_for("document.body.textContent.includes('Ready to arm')")
    firefox.move_to_button("Hold to arm")
    firefox.press_mouse()
    firefox.wait_for("document.body.textContent.includes('The fins may move')")
    firefox.release_mouse()
    assert stack.api.get("/robot").json()["armed"]
    firefox.wait_for(f"{DEPTH} > 0.2")
    firefox.move_to_button("you have control")
    firefox.click()
    firefox.wait_for(SHEET)
    firefox.press_key(ESCAPE)
    firefox.wait_for("!document.body.textContent.includes('The fins may move')")
    assert not stack.api.get("/robot").json()["armed"]
    firefox.wait_for(SHEET)


def test_firefox_flies_by_the_picture(firefox: Firefox, stack: Stack) -> None:
    bring_to_surface(stack)
    firefox.open("about:blank")
    firefox.open(f"{stack.url}/#/operate")
    firefox.wait_for("document.body.textContent.includes('Ready to arm')")
    firefox.press_key("f")
    firefox.wait_for(FLYING)
    firefox.wait_for(PICTURE)
    firefox.move_to_button("Controls")
    firefox.click()
    firefox.move_to_button("Hold to arm")
    firefox.press_mouse()
    firefox.wait_for("document.body.textContent.includes('The fins may move')")
    firefox.release_mouse()
    firefox.evaluate(f"void (globalThis.surface = {TAPES}.toDataURL())")
    firefox.wait_for(DEEP)
    firefox.wait_for(f"{TAPES}.toDataURL() !== surface")
    firefox.move_to_button("STOP")
    firefox.click()
    firefox.wait_for("!document.body.textContent.includes('The fins may move')")
    assert not stack.api.get("/robot").json()["armed"]
    # Esc is STOP; it does not leave.
    firefox.press_key(ESCAPE)
    firefox.wait_for("document.querySelector('.stop').textContent.includes('Stopped')")
    assert firefox.evaluate(FLYING)["value"] is True
    firefox.press_key("v")
    firefox.wait_for(f"!({FLYING}) && document.querySelector('.reading') !== null")


def test_firefox_opens_every_page(firefox: Firefox, stack: Stack) -> None:
    for view in VIEWS:
        firefox.open("about:blank")
        firefox.open(f"{stack.url}/#/{view.address}")
        headings = "[...document.querySelectorAll('h1, h2')]"
        firefox.wait_for(f"{headings}.some((one) => one.textContent.includes('{view.shows}'))")
        # Firefox complains of fonts and sockets that are still under way when a page is left.
        firefox.wait_for("document.fonts.status === 'loaded'")
        firefox.wait_for(CONNECTED)


def test_firefox_reads_a_decimal_comma_and_drops_no_character(firefox: Firefox, stack: Stack) -> None:
    firefox.open("about:blank")
    firefox.open(f"{stack.url}/#/tune/parameters")
    fields = "[...document.querySelectorAll('[role=spinbutton]')]"
    find = f"{fields}.find((one) => one.labels[0]?.textContent === 'control.set_point')"
    firefox.wait_for(f"{find}?.matches(':enabled')")
    for typed, invalid in (("0,6", "false"), ("1,234", "true"), ("0.6 m", "false")):
        firefox.evaluate(f"{find}.focus(), {find}.select()")
        for key in typed:
            firefox.press_key(key)
        firefox.wait_for(f"{find}.value === '{typed}' && {find}.ariaInvalid === '{invalid}'")
