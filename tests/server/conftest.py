"""A data folder of its own for every test, with a short path for its sockets."""

import tempfile
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest

from robot_runtime.config import RobotConfig
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from tests.server.new_database import place_empty
from tests.server.postgres import new_archive
from tests.server.serving import Served, serve


@pytest.fixture
def settings() -> Iterator[Settings]:
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        folder = DataFolder(Path(name) / "data")
        make_folders(folder)
        config = Path(name) / "robot.toml"
        text = '[robot]\nname = "tested"\n'
        config.write_text(text, encoding="utf-8")
        page = Path(name) / "page"
        yield Settings(
            data=folder, config=config, config_text=text, robot=RobotConfig(name="tested"), page=page
        )


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run the tests of a module that says so on both databases."""
    own = [mark for mark in metafunc.definition.iter_markers("parametrize") if mark.args[0] == "store"]
    if "store" in metafunc.fixturenames and getattr(metafunc.module, "BOTH_DATABASES", False) and not own:
        metafunc.parametrize("store", ["sqlite", "postgresql"], indirect=True)


@pytest.fixture
def store(request: pytest.FixtureRequest, settings: Settings) -> Iterator[Store]:
    if getattr(request, "param", "sqlite") == "postgresql":
        settings.data.lab.write_text(new_archive())
    else:
        place_empty(settings.data)
    store = Store(settings.data.database_location)
    yield store
    store.close()


@pytest.fixture
async def served(settings: Settings) -> AsyncIterator[Served]:
    """A server that runs in the test's own event loop."""
    async with serve(settings) as served:
        yield served
