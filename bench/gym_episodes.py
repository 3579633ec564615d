"""A hundred episodes of each agent of the manual, by its own lines."""

import io
import re
from contextlib import redirect_stdout

from tests.documents.blocks import read_blocks

SAID = re.compile(r"(\w+): (\d+) of (\d+) in the mean\n")


def measure() -> dict[str, float]:
    """Run the programs; return their episodes, and the mean return as a share of the greatest."""
    figures: dict[str, float] = {}
    for block in read_blocks("use/learn.md"):
        if block.language == "py":
            names: dict[str, object] = {}
            printed = io.StringIO()
            with redirect_stdout(printed):
                exec(compile(block.text, "learn.md", "exec"), names)
            match = SAID.fullmatch(printed.getvalue())
            assert match is not None, printed.getvalue()
            agent, mean, most = match[1].lower(), int(match[2]), int(match[3])
            returns = names["returns"]
            assert isinstance(returns, list)
            figures |= {f"gym_episodes.{agent}": len(returns), f"gym_episodes.{agent}_share": mean / most}
    return figures
