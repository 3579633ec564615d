"""One running robot and one Chromium for all browser tests; both end with them.

Playwright keeps an event loop running, which tests of other rooms could not stand beside their own.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize

from robot_runtime.transport.zenoh_transport import ZenohTransport
from tests.browser.opening import DESKTOP, PHONE, closing_pages, launched, opened_page, signed_in
from tests.browser.pages import stop_recordings
from tests.stack import Stack

RESET_SECONDS = 10.0


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("stack")


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with launched() as browser:
        yield browser


@pytest.fixture(autouse=True)
def _no_page_is_left(browser: Browser) -> Iterator[None]:
    with closing_pages(browser):
        yield


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
    return signed_in(browser, stack)


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
    bring_to_surface(stack)
    with opened_page(browser, stack, cookies, size) as page:
        yield page
        page.context.close()
        put_to_rest(stack)


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
    stop_recordings(stack)
    stack.api.post("/robot/commands/card", json={"colour": None}).raise_for_status()
