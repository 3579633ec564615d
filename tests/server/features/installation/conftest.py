"""Keys and a release for updates, which are judged soon."""

from pathlib import Path

import pytest

from server.features.installation import installer, updater
from tests.server.features.installation.signing import make_keys
from tests.server.features.installation.updatable import signed


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(updater, "HEALTHY_SECONDS", 0.02)
    monkeypatch.setattr(installer, "LOOK_SECONDS", 0.005)


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("keys")
    make_keys(folder)
    return folder


@pytest.fixture
def release(tmp_path: Path, keys: Path) -> Path:
    return signed(tmp_path / "release", keys, "2.0.0")
