"""A recorded dive, which is compared with itself or studied."""

import pytest

from server.platform.settings import Settings
from tests.server.analysis.dives import dive, record
from tests.server.new_database import new_store


@pytest.fixture
def session(settings: Settings) -> int:
    with new_store(settings.data) as store:
        return record(store, settings, dive(), name="one")
