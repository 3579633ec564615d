"""Scenes rendered on this computer, where that is possible."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING

import pytest

from robot_runtime.simulation.scene.availability import missing
from robot_runtime.simulation.scene.contents import Contents
from robot_runtime.simulation.water.parameters import SimulationParameters

if TYPE_CHECKING:
    from robot_runtime.simulation.scene.scene import SceneRenderer

Make = Callable[[Contents], "SceneRenderer"]


@pytest.fixture
def scene() -> Iterator[Make]:
    """Creates scenes, and closes them with the test."""
    problem = missing()
    if problem:
        pytest.skip(problem)
    from robot_runtime.simulation.scene.scene import SceneRenderer

    with ExitStack() as stack:
        yield lambda contents: stack.enter_context(SceneRenderer(contents, SimulationParameters()))
