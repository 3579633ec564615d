from collections.abc import Iterator

import pytest

from server.container import Container
from server.platform.settings import Settings
from tests.server.new_database import place_empty


@pytest.fixture
def container(settings: Settings) -> Iterator[Container]:
    """The services of a server that does not run, with an empty database."""
    place_empty(settings.data)
    container = Container(settings, (), "mucat_token")
    yield container
    container.store.close()
    container.audit.close()
