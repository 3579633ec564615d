"""Pictures of the documents: sixteen at most, and each of them is shown on a page."""

from pathlib import Path

PICTURES_MAX = 16
SUFFIXES = {".jpg", ".png", ".svg", ".gif", ".webp"}


def find_needless_pictures(root: Path) -> list[str]:
    """Return one line for each picture that no page shows, and one if there are too many."""
    docs = root / "docs"
    pictures = sorted(file for file in docs.rglob("*") if file.suffix in SUFFIXES)
    pages = "".join(page.read_text(encoding="utf-8") for page in [root / "README.md", *docs.rglob("*.md")])
    problems = [
        f"{picture.relative_to(root)} is shown on no page"
        for picture in pictures
        if f"{picture.name})" not in pages
    ]
    if len(pictures) > PICTURES_MAX:
        problems.append(f"docs/ has {len(pictures)} pictures; at most {PICTURES_MAX} are stored")
    return problems
