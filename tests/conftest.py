"""What all tests share."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

HERE = Path(__file__).parent
TOGETHER = {"browser"}
"""Folders whose tests share one robot."""

# A busy machine is slow, not wrong.
settings.register_profile("mucat", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("mucat")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Where several processes test: what shares something goes to the same one."""
    for item in items:
        file = item.path.relative_to(HERE)
        group = file.parts[0] if file.parts[0] in TOGETHER else str(file)
        item.add_marker(pytest.mark.xdist_group(group))
