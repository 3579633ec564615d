"""One running robot and one Chromium for all browser tests; both end with them.

Playwright keeps an event loop running, which tests of other rooms could not stand beside their own.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize, sync_playwright

from robot_runtime.transport.zenoh_transport import ZenohTransport
from tests.browser.chromium import ARGUMENTS, HEADLESS_SHELL, sign_in
from tests.stack import Stack

DESKTOP: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}
RESET_SECONDS = 10.0


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("stack")


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=HEADLESS_SHELL, args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture(autouse=True)
def _no_page_is_left(browser: Browser) -> Iterator[None]:
    """Close what a failed test has left open: such pages would take the computer from the tests after it."""
    before = list(browser.contexts)
    yield
    for context in [one for one in browser.contexts if one not in before]:
        context.close()


@pytest.fixture(scope="package")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    # Cards look alike there at every moment, wherever the robot swims.
    config = tmp_path_factory.mktemp("config") / "robot.toml"
    config.write_text(Path("robot.toml").read_text().replace('camera = "scene"', 'camera = "card"'))
    with Stack(tmp_path_factory.mktemp("data"), "--config", str(config)) as stack:
        yield stack


@pytest.fixture(scope="package")
def cookies(browser: Browser, stack: Stack) -> StorageState:
    """Cookies and storage of a signed-in operator."""
    context = browser.new_context()
    sign_in(context, stack.url, stack.data)
    kept = context.storage_state()
    context.close()
    return kept


@pytest.fixture(params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def any_page(
    request: pytest.FixtureRequest, browser: Browser, stack: Stack, cookies: StorageState
) -> Iterator[Page]:
    """The page at both sizes; what its code complains about fails the test."""
    yield from open_page(browser, stack, cookies, request.param)


@pytest.fixture
def page(browser: Browser, stack: Stack, cookies: StorageState) -> Iterator[Page]:
    """The page at desktop size; what its code complains about fails the test."""
    yield from open_page(browser, stack, cookies, DESKTOP)


def open_page(browser: Browser, stack: Stack, cookies: StorageState, size: ViewportSize) -> Iterator[Page]:
    """The page at this size, robot at the surface; afterwards all is at rest."""
    # Charts then move once a second, which leaves the computer to what is tested.
    context = browser.new_context(
        viewport=size, storage_state=cookies, reduced_motion="reduce", color_scheme="dark"
    )
    page = context.new_page()
    complaints: list[str] = []
    bring_to_surface(stack)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(stack.url)
    yield page
    context.close()
    put_to_rest(stack)
    assert complaints == []


def bring_to_surface(stack: Stack) -> None:
    """Put the robot where every test finds it, wherever the one before has left it."""
    runtime = f"unixsock-stream/{stack.data}/run/runtime.sock"
    with ZenohTransport("turtle", connect=[runtime], client=True) as messages:
        messages.query("simulator/reset", {}, RESET_SECONDS)


def put_to_rest(stack: Stack) -> None:
    """Bring the robot back to the state in which a test finds it."""
    stack.api.post("/comm-tests/cancel").raise_for_status()
    stack.api.post("/robot/stop").raise_for_status()
    stack.api.post("/robot/commands/acknowledge").raise_for_status()
    for session in stack.api.get("/sessions").json():
        if session["state"] == "recording":
            stack.api.post(f"/sessions/{session['id']}/stop").raise_for_status()
    stack.api.post("/robot/commands/card", json={"colour": None}).raise_for_status()
