"""`make notebooks`: runs the notebooks, and writes their pages and figures into docs/."""

from tests.notebooks.performance import perform
from tests.notebooks.runner import FOLDER, NAMES, page_of

PICTURES = FOLDER.parents[1] / "pictures"


def main() -> None:
    """Write each page."""
    for name, cells in perform(NAMES).items():
        text, figures = page_of(name, cells)
        (FOLDER / f"{name}.md").write_text(text, encoding="utf-8")
        for file, svg in figures.items():
            (PICTURES / file).write_text(svg, encoding="utf-8")


if __name__ == "__main__":
    main()
