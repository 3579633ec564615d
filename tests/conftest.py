"""Hypothesis settings, garbage collection, the end of a process of tests, and the robot they share."""

import faulthandler
import gc
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.processor_time import ProcessorTime
from tests.stack import Stack

# A busy machine is slow, not wrong.
settings.register_profile("mucat", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("mucat")


END_SECONDS = 60.0
"""Time that a process of tests has for its end."""

# While modules are loaded there is next to no garbage.
gc.disable()


def pytest_configure(config: pytest.Config) -> None:
    """Count processor time where durations are asked for, too."""
    if config.option.durations:
        config.pluginmanager.register(ProcessorTime())


def pytest_collection_finish() -> None:
    """Modules stay to the end: to examine them again and again would take a fifth of the processor time."""
    gc.enable()
    gc.collect()
    gc.freeze()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Move tests of the shared robot to the end, so that it does not run beside another one."""
    items.sort(key=lambda item: "shared_stack" in getattr(item, "fixturenames", ()))


def pytest_unconfigure() -> None:
    """A thread that never ends would keep this process: it then fails, and says where its threads are."""
    faulthandler.dump_traceback_later(END_SECONDS, exit=True, file=2)


@pytest.fixture(scope="session")
def anyio_backend() -> str:
    """Run async tests and fixtures in asyncio's event loop, one for each test."""
    return "asyncio"


@pytest.fixture(scope="session")
def _running() -> Iterator[Stack]:
    with tempfile.TemporaryDirectory(prefix="mucat-") as name, Stack(Path(name) / "data") as stack:
        yield stack


@pytest.fixture
def shared_stack(_running: Stack) -> Stack:
    """A running robot, disarmed and ready to arm, with the sessions and settings of the tests before."""
    _running.calm()
    return _running
