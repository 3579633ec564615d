import platform
from pathlib import Path

import pytest

from packages.architectures import ARCHITECTURES
from packages.wheels import build_emulator, build_mucat
from tests.packages.installation import Installation


@pytest.fixture(scope="session")
def mucat_wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel `mucat` of this source, built now, alone in its folder."""
    return build_mucat(tmp_path_factory.mktemp("wheels"))


@pytest.fixture(scope="session")
def installation(mucat_wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installation:
    """The wheels of this source, installed."""
    folder = tmp_path_factory.mktemp("installation")
    emulator = build_emulator(ARCHITECTURES[platform.machine()], folder)
    return Installation(folder / "environment", [mucat_wheel, emulator])


@pytest.fixture
def elsewhere(tmp_path: Path) -> Path:
    """An empty folder in which a person starts mucat."""
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    return folder
