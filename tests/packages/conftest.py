import platform
from pathlib import Path

import pytest

from packages.architectures import ARCHITECTURES
from packages.wheels import build_emulator, build_mucat
from tests.packages.installation import Installation


@pytest.fixture(scope="session")
def installation(tmp_path_factory: pytest.TempPathFactory) -> Installation:
    """The wheels of this source, built now and installed."""
    folder = tmp_path_factory.mktemp("wheels")
    wheels = [
        build_mucat(folder),
        build_emulator(ARCHITECTURES[platform.machine()], folder),
    ]
    return Installation(folder / "environment", wheels)


@pytest.fixture
def elsewhere(tmp_path: Path) -> Path:
    """An empty folder in which a person starts mucat."""
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    return folder
