"""A data folder of its own for every test, with a short path for its sockets."""

import tempfile
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest

from robot_runtime.config import RobotConfig
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store
from tests.server.new_database import place_empty
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


@pytest.fixture
def store(settings: Settings) -> Iterator[Store]:
    place_empty(settings.data)
    store = Store(settings.data.database)
    yield store
    store.close()


@pytest.fixture
async def served(settings: Settings) -> AsyncIterator[Served]:
    """A server that runs in the test's own event loop."""
    async with serve(settings) as served:
        yield served
