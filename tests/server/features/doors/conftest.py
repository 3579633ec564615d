from collections.abc import Iterator

import pytest

from server.container import Container
from server.http.audit import AuditLog
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.new_database import place_empty


@pytest.fixture
def container(settings: Settings) -> Iterator[Container]:
    """The services of a server that does not run, with an empty database."""
    place_empty(settings.data)
    container = Container(settings, (), "mucat_token")
    yield container
    container.services.get(Store).close()
    container.services.get(AuditLog).close()
