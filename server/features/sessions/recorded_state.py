"""`state` documents as recordings have them, of this version and earlier ones."""

from collections.abc import Mapping
from typing import Any


def depth_loop(state: Mapping[str, Any]) -> Mapping[str, Any]:
    """The depth loop: its set point, its controller and the choice of controllers.

    The first versions had these fields in the document itself, and no loops.
    """
    return next((loop for loop in state.get("loops", ()) if loop["name"] == "depth"), state)
