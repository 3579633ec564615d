"""A short version of `make interface`: requests by schemathesis to every operation."""

import warnings
from collections.abc import Iterator
from functools import cache

import pytest

from server import board_reservation as reservation
from server.app import create_app
from server.platform.settings import DataFolder, Settings
from tests.board.rig import ROOT
from tests.proofs.interface import Surface, run_surface

EXAMPLES = 12


@cache
def operations() -> list[str]:
    app = create_app(Settings(data=DataFolder(ROOT), config=ROOT / "robot.toml", every_feature=True))
    paths = app.openapi()["paths"].values()
    return [operation["operationId"] for path in paths for operation in path.values()]


@pytest.fixture(scope="module")
def surface() -> Iterator[Surface]:
    with pytest.MonkeyPatch.context() as patch, run_surface() as surface:
        # Nobody is there to disarm the robot, for which each request that needs its board would wait.
        patch.setattr(reservation, "DISARM_SECONDS", 0.1)
        yield surface


@pytest.mark.parametrize("name", operations())
def test_an_operation_answers_as_it_is_described_and_never_fails(surface: Surface, name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        surface.prove(name, EXAMPLES)


def test_every_operation_is_asked(surface: Surface) -> None:
    assert sorted(surface.operations) == sorted(operations())
