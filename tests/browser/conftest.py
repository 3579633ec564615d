"""One running robot for all browser tests; it ends with them."""

import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from robot_runtime.errors import NoAnswerError
from robot_runtime.transport.zenoh_transport import join
from tests.browser.fixtures import _no_page_is_left, any_page, browser, cookies, page
from tests.browser.pages import stop_recordings
from tests.stack import Stack

__all__ = ["_no_page_is_left", "any_page", "browser", "cookies", "page"]
RESET_SECONDS = 10.0


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("stack")


@pytest.fixture(scope="package")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    # Cards look alike there at every moment, wherever the robot swims.
    config = tmp_path_factory.mktemp("config") / "robot.toml"
    config.write_text(Path("robot.toml").read_text().replace('camera = "scene"', 'camera = "card"'))
    with Stack(tmp_path_factory.mktemp("data"), "--config", str(config)) as stack:
        yield stack


@pytest.fixture(scope="package")
def site(stack: Stack) -> Stack:
    """The server of the robot."""
    return stack


@pytest.fixture
def _at_rest(stack: Stack) -> Iterator[None]:
    """The robot is at the surface; afterwards all is at rest."""
    bring_to_surface(stack)
    yield
    put_to_rest(stack)


def bring_to_surface(stack: Stack) -> None:
    """Put the robot where every test finds it, wherever the one before has left it."""
    runtime = f"unixsock-stream/{stack.data}/run/runtime.sock"
    with join("turtle", [runtime]) as messages:
        end = time.monotonic() + RESET_SECONDS
        while True:
            # One that has just been started, after a bring-up, is found by others a moment later.
            with suppress(NoAnswerError):
                messages.query("simulator/reset", {}, RESET_SECONDS)
                return
            assert time.monotonic() < end, "the simulator is not found"


def put_to_rest(stack: Stack) -> None:
    """Bring the robot back to the state in which a test finds it."""
    stack.api.post("/comm-tests/cancel").raise_for_status()
    stack.api.post("/robot/stop").raise_for_status()
    stack.api.post("/robot/commands/acknowledge").raise_for_status()
    stop_recordings(stack)
    stack.api.post("/robot/commands/card", json={"colour": None}).raise_for_status()
