"""Blocks with the craft, as the simulator sends them."""

from typing import Any

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.documents import SwimmingCraft
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents


def craft_block(number: int, title: str = "Turtle 2", *, time: float = 100.0, **numbers: Any) -> Block:
    """Return a block of the default craft with these numbers."""
    document = SwimmingCraft(time=time, title=title, origin="weighed", craft=Craft(**numbers))
    return Block.of(BY_NAME["craft"], 1, number, pack_documents([document]))
