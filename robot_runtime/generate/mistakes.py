"""docs/reference/mistakes.md: every mistake of wiring and parts that an emulated board can have."""

from robot_runtime.generate.markdown import fill, page, table
from robot_runtime.simulation.boards.mistakes import FINS, MISTAKES, PARTS, notation

SOURCE = "robot_runtime/simulation/boards/mistakes.py"


def mistakes_page() -> str:
    """Return the whole text of mistakes.md."""
    rows = ((f"`{notation(name)}`", mistake.meaning) for name, mistake in MISTAKES.items())
    names = {"fins": _names(FINS), "parts": _names(PARTS), "mistakes": table(("mistake", "the board"), rows)}
    return page("Mistakes", SOURCE, fill("mistakes", **names))


def _names(texts: tuple[str, ...]) -> str:
    return ", ".join(f"`{text}`" for text in texts)
